#include "core/solve/placement/choose_lights.h"

#include <gtest/gtest.h>

#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

ChooseOptions choose_most(std::size_t lights) {
  ChooseOptions options;
  options.most_lights = lights;
  return options;
}

TEST(ChooseLights, FindsHowManyKnownLightsThereAre) {
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

TEST(ChooseLights, GivesACurveThatFallsAndLightsForEveryPointOfIt) {
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
  // Two more would not have lowered the error by a tenth each.
  const std::size_t k = curve.chosen;
  ASSERT_LT(k, curve.cuts.size());
  if (k + 2 < curve.cuts.size()) {
    EXPECT_GT(curve.cuts[k + 2].error(), 0.81 * curve.cuts[k].error());
  }
}

TEST(ChooseLights, GivesTheSameForAnyNumberOfThreadsAndTheBestSoFarWhenStopped) {
  const LitHall hall(make_box_room(2), 0.4);
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 200);
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  ChooseOptions options = choose_most(6);
  options.most_columns = 3000;
  options.exchange.threads = 1;
  const LightCurve one = choose_lights(*hall.light, goal, candidates, options);
  options.exchange.threads = 4;
  const LightCurve four = choose_lights(*hall.light, goal, candidates, options);
  ASSERT_EQ(one.cuts.size(), four.cuts.size());
  for (std::size_t k = 0; k < one.cuts.size(); ++k) EXPECT_EQ(one.cuts[k].poses(), four.cuts[k].poses());

  std::stop_source stop;
  options.exchange.watch.stop = stop.get_token();
  options.better = [&](const PlacedLights& best, std::size_t) {
    if (best.size() == 2) stop.request_stop();
  };
  const LightCurve stopped = choose_lights(*hall.light, goal, candidates, options);
  EXPECT_GE(stopped.cuts.size(), 3u);
  EXPECT_LT(stopped.columns, one.columns);
}

TEST(ChooseLights, TakesAGoalOfZeroAndRoomsWithoutCandidates) {
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
