/// Placement in rooms from a millimetre to kilometres, far from the origin, with lights that touch surfaces, and with
/// goals that cannot be met.

#include <gtest/gtest.h>

#include <limits>

#include "core/solve/placement/place_lights.h"
#include "core/solve/placement/search/choose_lights.h"
#include "tests/core/solve/placement/lit_hall.h"
#include "tests/random.h"

namespace luxrig {
namespace {

/// The room scaled about the origin, then moved.
LitRoom rescaled(LitRoom room, double scale, const Vec3& to_m) {
  for (auto& vertex : room.scene.vertices_m) vertex *= static_cast<float>(scale);
  room.scene.origin_world_m = scale * room.scene.origin_world_m + to_m;
  for (Receiver& receiver : room.receivers) receiver.position_world_m = scale * receiver.position_world_m + to_m;
  return room;
}

class PlacementStress : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(PlacementStress, FindsTheSameLightsAtAnyScaleAndPlace) {
  const auto [scale, far_m] = GetParam();
  const Vec3 to_m(far_m, -far_m, far_m / 2);
  const LitHall hall(rescaled(make_box_room(3), scale, to_m), 0.25 * scale);
  std::vector<Vec3> places_m;
  for (const Vec3& at_m : {Vec3(0.9, 0.8, 2.1), Vec3(3.1, 2.2, 1.9)}) places_m.push_back(scale * at_m + to_m);
  const LightingGoal goal = hall.goal_of(places_m, {800, 500});
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  PlaceOptions options;
  options.lights = 2;
  options.max_columns = 20'000;
  options.exchange = ExchangeOptions::for_spacing(0.25 * scale);
  const Placement got = place_lights(*hall.light, goal, candidates, options);
  // At 10⁶ m from the origin, doubles and float rays are exact to a millimetre.
  const double exact = std::max(1e-4, 1e-9 * far_m / scale);
  EXPECT_LE(got.lights.error(), exact);
  for (const Vec3& place_m : places_m) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const LightPose& pose : got.lights.poses())
      nearest_m = std::min(nearest_m, (pose.position_world_m - place_m).norm());
    EXPECT_LE(nearest_m, (0.01 + 20 * exact) * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(Scales, PlacementStress,
                         testing::Values(std::pair{1.0, 0.0}, std::pair{1e-3, 0.0}, std::pair{1e3, 0.0},
                                         std::pair{1.0, 1e6}, std::pair{100.0, 1e6}));

TEST(PlacementStress, UnreachablePointsStayDarkAndTheOthersAreLit) {
  const LitHall whole(make_box_room(1), 0.4);
  LitRoom room = make_box_room(1);
  room.receivers.resize(20);
  for (int i = 0; i < 5; ++i) room.receivers.push_back({{50.0 + i, 50, 50}, Vec3::UnitZ()});
  const LitHall hall(room, 0.4);
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 100);
  goal.row_weight = Eigen::VectorXd::Ones(goal.lux.size());
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  ChooseOptions options;
  options.max_lights = 4;
  options.max_columns = 5'000;
  const LightCurve curve = choose_lights(*hall.light, goal, candidates, options);
  const PlacedLights& best = curve.cuts[curve.chosen];
  ASSERT_GT(best.size(), 0u);
  EXPECT_GE(best.error(), std::sqrt(5.0 / 25.0) - 1e-9);
  EXPECT_LT(best.error(), 0.8);
  EXPECT_TRUE(best.levels().allFinite());
}

TEST(PlacementStress, LightsOnSurfacesOrAtPointsAreRefusedOrFinite) {
  const LitHall hall(make_box_room(2), 0.5);
  Eigen::VectorXd lux;
  Eigen::MatrixXd slopes;
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Receiver& receiver = hall.room.receivers[static_cast<std::size_t>(
        random.between(0, static_cast<double>(hall.room.receivers.size() - 1)))];
    const double off_m = trial % 3 == 0 ? 0 : std::pow(10, random.between(-12, -1));
    LightPose pose{receiver.position_world_m + off_m * random.direction()};
    if (hall.light->column(pose, lux, &slopes)) {
      EXPECT_TRUE(lux.allFinite());
      EXPECT_GE(lux.minCoeff(), 0);
      EXPECT_TRUE(slopes.allFinite()) << off_m;
    }
  }
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300})
    EXPECT_FALSE(hall.light->column({{bad, 0, 0}}, lux, &slopes) && !lux.allFinite());
}

TEST(PlacementStress, OnePointAndOneCandidateAreEnough) {
  LitRoom room = make_box_room(1);
  room.receivers.resize(1);
  const LitHall hall(room, 0.5);
  const LightPose above{room.receivers[0].position_world_m + 0.5 * room.receivers[0].normal_world};
  Eigen::VectorXd lux;
  ASSERT_TRUE(hall.light->column(above, lux, nullptr));
  const std::vector<std::uint64_t> begin = {0, 1};
  const std::vector<std::uint32_t> row = {0};
  const std::vector<float> value = {static_cast<float>(lux[0])};
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(1, 250);
  const std::vector<LightPose> poses = {above};
  const ComplementSearch candidates(ColumnsView(1, begin, row, value), poses, goal);
  const Placement got = place_lights(*hall.light, goal, candidates, {});
  EXPECT_LE(got.lights.error(), 1e-9);
  const LightCurve curve = choose_lights(*hall.light, goal, candidates, {});
  EXPECT_EQ(curve.chosen, 1u);
}

}  // namespace
}  // namespace luxrig
