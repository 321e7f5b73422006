#include "core/solve/bounds/goal_bounds.h"

#include <gtest/gtest.h>

#include "core/solve/least_squares/nnls.h"
#include "tests/core/solve/placement/lit_hall.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Weighted goal with existing light, in one channel or three.
LightingGoal drawn_goal(Random& random, Index points, Index channels) {
  LightingGoal goal;
  goal.lux.resize(points * channels);
  for (double& lux : goal.lux) lux = random.between(50, 400);
  goal.row_weight.resize(goal.lux.size());
  for (double& weight : goal.row_weight) weight = random.between(0.2, 2);
  goal.fixed_lux = 0.3 * random.between(0, 1) * goal.lux;
  if (channels == 3) goal.emitters = (Eigen::Matrix3d() << 0.9, 0.1, 0, 0.1, 0.8, 0.1, 0, 0.1, 0.9).finished();
  return goal;
}

TEST(GoalBounds, AreBelowTheBestOfAllPairsInOneAndThreeChannels) {
  const LitHall hall(make_box_room(2), 0.9);
  const auto points = static_cast<Index>(hall.room.receivers.size());
  Random random(3);
  for (int trial = 0; trial < 6; ++trial) {
    const LightingGoal goal = drawn_goal(random, points, trial % 2 == 0 ? 1 : 3);
    double best_one = 1, best_two = 1;
    for (std::size_t a = 0; a < hall.poses.size(); ++a) {
      PlacedLights lights(*hall.light, goal);
      if (!lights.add(hall.poses[a])) continue;
      best_one = std::min(best_one, lights.error());
      for (std::size_t b = 0; b < a; ++b) {
        PlacedLights both = lights;
        if (both.add(hall.poses[b])) best_two = std::min(best_two, both.error());
      }
    }
    CountBoundOptions options;
    options.max_lights = 2;
    const std::vector<double> bounds = goal_error_bounds_by_count(hall.view(), goal, options);
    const double any = goal_error_bound(hall.view(), goal);
    // Columns of candidates are float.
    EXPECT_LE(bounds[1], best_one * (1 + 1e-6));
    EXPECT_LE(bounds[2], best_two * (1 + 1e-6));
    EXPECT_LE(any, bounds[2] + 1e-6);
    EXPECT_GT(bounds[1], 0.9 * best_one) << trial;
    EXPECT_GT(bounds[2], 0.7 * best_two) << trial;
    PlacedLights none(*hall.light, goal);
    EXPECT_NEAR(bounds[0], none.error(), 1e-9);
  }
}

TEST(GoalBounds, ForAnyNumberMatchLeastSquaresOverAllCandidates) {
  const LitHall hall(make_box_room(2), 0.9);
  Random random(5);
  const LightingGoal goal = drawn_goal(random, static_cast<Index>(hall.room.receivers.size()), 1);
  PlacedLights all(*hall.light, goal);
  for (const LightPose& pose : hall.poses) (void)all.add(pose);
  EXPECT_NEAR(goal_error_bound(hall.view(), goal), all.error(), 1e-6);
  EXPECT_EQ(goal_error_bound(hall.view(), {VectorXd::Zero(goal.lux.size()), {}}), 0);
}

}  // namespace
}  // namespace luxrig
