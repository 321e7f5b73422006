#include "core/solve/placement/place_lights.h"

#include <gtest/gtest.h>

#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

TEST(PlaceLights, SkipsTheSecondStartWhereTheGoalCanBeMet) {
  const LitHall hall(make_box_room(3), 0.25);
  const LightingGoal goal = hall.goal_of({{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}}, {800, 500});
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  PlaceOptions options;
  options.lights = 2;
  options.other = [](std::size_t, std::uint64_t) {
    ADD_FAILURE() << "it costs seconds";
    return std::vector<LightPose>();
  };
  EXPECT_LE(place_lights(*hall.light, goal, candidates, options).lights.error(), 1e-4);
}

TEST(PlaceLights, ReportsImprovementsAndReturnsTheBestWhenStopped) {
  const LitHall hall(make_box_room(1), 0.4);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200)};
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  std::stop_source stop;
  PlaceOptions options;
  options.lights = 2;
  options.wanted_error = 0;
  options.exchange.watch.stop = stop.get_token();
  double last = 2;
  int told = 0;
  options.better = [&](const PlacedLights& best, std::size_t) {
    EXPECT_LT(best.error(), last);
    last = best.error();
    ++told;
    stop.request_stop();
  };
  const Placement got = place_lights(*hall.light, goal, candidates, options);
  EXPECT_GE(told, 1);
  EXPECT_EQ(got.lights.error(), last);
}

TEST(PlaceLights, HandlesZeroGoalsUnreachablePointsAndEqualCandidates) {
  LitHall hall(make_box_room(1), 0.5);
  const Eigen::Index points = hall.light->points();
  // Each candidate twice.
  CandidateColumns twice;
  std::vector<LightPose> poses;
  for (std::size_t c = 0; c < hall.columns.columns(); ++c)
    for (int copy = 0; copy < 2; ++copy) {
      for (std::uint64_t e = hall.columns.begin[c]; e < hall.columns.begin[c + 1]; ++e) {
        twice.receiver.push_back(hall.columns.receiver[e]);
        twice.total_lux.push_back(hall.columns.total_lux[e]);
      }
      twice.begin.push_back(twice.receiver.size());
      poses.push_back(hall.poses[c]);
    }
  const ColumnsView view(points, twice.begin, twice.receiver, twice.total_lux);
  LightingGoal zero{Eigen::VectorXd::Zero(points)};
  LightingGoal one{Eigen::VectorXd::Zero(points), Eigen::VectorXd::Zero(points)};
  one.lux[0] = 100;
  one.row_weight[0] = 1;
  for (const LightingGoal& goal : {zero, one}) {
    const ComplementSearch candidates(view, poses, goal);
    PlaceOptions options;
    options.lights = 4;
    options.max_columns = 2000;
    const Placement got = place_lights(*hall.light, goal, candidates, options);
    EXPECT_LE(got.lights.error(), 1e-4);
    EXPECT_TRUE(got.lights.levels().allFinite());
    EXPECT_TRUE((got.lights.levels().array() >= 0).all());
  }
  // A candidate that lights nothing.
  const std::vector<std::uint64_t> begin = {0, 0};
  const std::vector<LightPose> outside = {{{100, 100, 100}}};
  const ColumnsView dark(points, begin, std::span<const std::uint32_t>(), std::span<const float>());
  const LightingGoal goal{Eigen::VectorXd::Constant(points, 100)};
  const ComplementSearch candidates(dark, outside, goal);
  const Placement none = place_lights(*hall.light, goal, candidates, {});
  EXPECT_EQ(none.lights.size(), 0u);
  EXPECT_EQ(none.lights.error(), 1);
}

}  // namespace
}  // namespace luxrig
