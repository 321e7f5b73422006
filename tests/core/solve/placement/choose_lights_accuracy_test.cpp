/// choose_lights: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/solve/placement/search/choose_lights.h"
#include "tests/core/solve/placement/choose_lights_fixture.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

using namespace choose_lights_fixture;

TEST(ChooseLights, GivesAFallingCurveWithLightsForEachOfItsPoints) {
  const LitHall hall(make_box_room(1), 0.3);
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 200);
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  const LightCurve curve = choose_lights(*hall.light, goal, candidates, choose_most(10));
  ASSERT_GE(curve.cuts.size(), 3u);
  EXPECT_EQ(curve.cuts[0].size(), 0u);
  EXPECT_EQ(curve.cuts[0].error(), 1);
  for (std::size_t k = 1; k < curve.cuts.size(); ++k) {
    EXPECT_LE(curve.cuts[k].size(), k);
    EXPECT_LE(curve.cuts[k].error(), curve.cuts[k - 1].error());
    const PlacedLights& cut = curve.cuts[k];
    EXPECT_NEAR((cut.columns() * cut.levels() - goal.lux).norm() / goal.lux.norm(), cut.error(), 1e-12);
  }
  // Two more lights would not have lowered the error by a tenth each.
  const std::size_t k = curve.chosen;
  ASSERT_LT(k, curve.cuts.size());
  if (k + 2 < curve.cuts.size()) {
    EXPECT_GT(curve.cuts[k + 2].error(), 0.81 * curve.cuts[k].error());
  }
}

}  // namespace
}  // namespace luxrig
