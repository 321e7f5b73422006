#include "core/solve/placement/search/choose_lights.h"

#include <gtest/gtest.h>

#include "tests/core/solve/placement/choose_lights_fixture.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

using namespace choose_lights_fixture;

TEST(ChooseLights, FindsTheNumberOfKnownLights) {
  const LitHall hall(make_box_room(3), 0.25);
  const std::vector<Vec3> places_m = {{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}, {2.2, 1.4, 2.3}, {0.6, 2.4, 1.5}};
  for (std::size_t count = 1; count <= places_m.size(); ++count) {
    const LightingGoal goal =
        hall.goal_of({places_m.begin(), places_m.begin() + static_cast<std::ptrdiff_t>(count)}, {800, 500, 300, 600});
    const ComplementSearch candidates(hall.view(), hall.poses, goal);
    const LightCurve curve = choose_lights(*hall.light, goal, candidates, choose_most(12));
    EXPECT_EQ(curve.chosen, count);
    EXPECT_LE(curve.cuts[curve.chosen].error(), 1e-4);
    EXPECT_EQ(curve.cuts[curve.chosen].size(), count);
  }
}

TEST(ChooseLights, HandlesAZeroGoalAndRoomsWithoutCandidates) {
  const LitHall hall(make_box_room(1), 0.5);
  LightingGoal zero;
  zero.lux = Eigen::VectorXd::Zero(hall.light->points());
  const ComplementSearch candidates(hall.view(), hall.poses, zero);
  const LightCurve none = choose_lights(*hall.light, zero, candidates, {});
  EXPECT_EQ(none.chosen, 0u);
  EXPECT_EQ(none.cuts[0].error(), 0);

  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 100);
  const std::vector<std::uint64_t> begin = {0, 0};
  const std::vector<LightPose> outside = {{{100, 100, 100}}};
  const ColumnsView dark(hall.light->points(), begin, std::span<const std::uint32_t>(), std::span<const float>());
  const ComplementSearch nothing(dark, outside, goal);
  const LightCurve unlit = choose_lights(*hall.light, goal, nothing, {});
  EXPECT_EQ(unlit.chosen, 0u);
  EXPECT_EQ(unlit.cuts.size(), 1u);
}

}  // namespace
}  // namespace luxrig
