#include "core/solve/placement/scene/place_in_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/core/solve/placement/mounted_room.h"
#include "tests/core/solve/placement/place_in_scene_fixture.h"

namespace luxrig {
namespace {

using namespace place_in_scene_fixture;

double farthest_m(const std::vector<LightInScene>& known, const std::vector<LightInScene>& found) {
  double farthest = 0;
  for (const LightInScene& light : known) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const LightInScene& at : found)
      nearest = std::min(nearest, (at.position_world_m - light.position_world_m).norm());
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

TEST(PlaceInScene, FindsKnownLightsUnderACeiling) {
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.lights = 3;
  options.error_wanted = 1e-5;
  const auto found = room.place(room.goal_of(kThree), options);
  ASSERT_TRUE(found);
  EXPECT_LE(found->error, 1e-5);
  ASSERT_EQ(found->lights.size(), 3u);
  EXPECT_LE(farthest_m(kThree, found->lights), 0.01);
  for (const LightInScene& light : found->lights) EXPECT_TRUE(room.mounting.may_hang(light.position_world_m));
}

TEST(PlaceInScene, FindsTheNumberOfLights) {
  const LitFloor room;
  const auto found = room.place(room.goal_of(kThree), direct_light());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lights.size(), 3u);
  ASSERT_GE(found->numbers.size(), 3u);
  EXPECT_GT(found->numbers[0].error, found->numbers[1].error);
  EXPECT_LE(found->numbers[2].error, 0.001);
}

TEST(PlaceInScene, AddsNoLightsThatBringTooLittle) {
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.max_lights = 5;
  options.improvement = 0.99;  // not even the second light improves that much
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  const auto found = room.place(even, options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lights.size(), 1u);
  EXPECT_GE(found->numbers.size(), 2u) << "more were looked at";
}

TEST(PlaceInScene, AddsLightsWhereOneCannotGiveEnough) {
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.max_level = 250;
  options.max_lights = 4;
  const auto found = room.place(room.goal_of({{{2, 1.5, 2.3}, {}, 500}}), options);
  ASSERT_TRUE(found);
  ASSERT_GE(found->numbers.size(), 2u);
  // Half of the light leaves half of the error at its place, slightly less nearer to the floor.
  EXPECT_LE(found->numbers[0].error, 0.5);
  EXPECT_GE(found->numbers[0].error, 0.4);
  EXPECT_GE(found->lights.size(), 2u);
  for (const LightInScene& light : found->lights) EXPECT_LE(light.level, 250);
}

TEST(PlaceInScene, PlacesLightsAtTheEdgeWhenTheyLieOutside) {
  // These lights hang lower than allowed: the best place is at the far offset.
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.lights = 1;
  const auto found = room.place(room.goal_of({{{2, 1.5, 1.9}, {}, 500}}), options);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->lights.size(), 1u);
  const Vec3& at = found->lights[0].position_world_m;
  EXPECT_NEAR(at.z(), 2.2, 1e-6);
  EXPECT_NEAR(at.x(), 2, 0.02);
  EXPECT_NEAR(at.y(), 1.5, 0.02);
}

TEST(PlaceInScene, ReturnsTheBestSoFarWhenStopped) {
  const LitFloor room;
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  std::stop_source stop;
  PlaceInSceneOptions options = direct_light();
  options.lights = 4;
  options.watch.stop = stop.get_token();
  double best = 1;
  options.better = [&](std::size_t, double error) {
    best = error;
    stop.request_stop();
  };
  const auto found = room.place(even, options);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->stopped);
  EXPECT_FALSE(found->lights.empty());
  EXPECT_EQ(found->error, best);
  const auto nothing = room.place(even, options);
  ASSERT_FALSE(nothing) << "stopped before it began";
  EXPECT_EQ(nothing.error().cause, Cause::cancelled);
}

/// Two lamps with red, green, blue and white emitters, by the inverse square law. Goals are stacked by primary.
TEST(PlaceInScene, FindsMultiEmitterLampsFromColourGoals) {
  const LitFloor room;
  const auto points = static_cast<Eigen::Index>(room.receivers.size());
  LightingGoal goal;
  goal.emitters.resize(3, 4);
  goal.emitters << within_rec709(rgb_of_xy({0.62, 0.34})).rgb, within_rec709(rgb_of_xy({0.31, 0.58})).rgb,
      within_rec709(rgb_of_xy({0.16, 0.08})).rgb, rgb_of_cct(3000);
  goal.watts = Eigen::Vector4d(0.02, 0.02, 0.05, 0.01);
  const std::vector<LightInScene> known = {{{0.8, 0.7, 2.3}, {}, 1}, {{3.1, 2.2, 2.25}, {}, 1}};
  const Eigen::Vector4d lumens[] = {{300, 100, 0, 400}, {0, 200, 80, 100}};
  goal.lux = Eigen::VectorXd::Zero(3 * points);
  for (std::size_t k = 0; k < 2; ++k) {
    const Eigen::VectorXd lux = room.goal_of({known[k]}).lux;
    for (Eigen::Index c = 0; c < 3; ++c) goal.lux.segment(c * points, points) += (goal.emitters * lumens[k])[c] * lux;
  }
  PlaceInSceneOptions options = direct_light();
  options.lights = 2;
  options.error_wanted = 1e-5;
  options.front_limits = 4;
  const auto found = room.place(goal, options);
  ASSERT_TRUE(found);
  EXPECT_LE(found->error, 1e-5);
  ASSERT_EQ(found->lights.size(), 2u);
  EXPECT_LE(farthest_m(known, found->lights), 0.01);
  for (std::size_t k = 0; k < 2; ++k) {
    const bool first = (found->lights[0].position_world_m - known[k].position_world_m).norm() < 0.1;
    const LightInScene& light = found->lights[first ? 0 : 1];
    ASSERT_EQ(light.levels.size(), 4u);
    EXPECT_EQ(light.level, *std::max_element(light.levels.begin(), light.levels.end()));
    // Three channels cannot separate four emitters: only their sum must match.
    const Eigen::Map<const Eigen::Vector4d> levels(light.levels.data());
    EXPECT_NEAR((goal.emitters * (levels - lumens[k])).norm(), 0, 0.01 * (goal.emitters * lumens[k]).norm());
  }
  ASSERT_EQ(found->front.size(), 5u);
  EXPECT_LE(found->front[0].error, found->error);
  for (std::size_t k = 0; k < 5; ++k) {
    const PowerAndError& at = found->front[k];
    EXPECT_NEAR(at.max_watts, found->front[0].max_watts * (1 - static_cast<double>(k) / 5), 1e-9);
    EXPECT_LE(at.watts, at.max_watts);
    EXPECT_GE(at.error, found->front[k > 0 ? k - 1 : 0].error);
  }
  // With a fifth of the power most of the light is missing.
  EXPECT_GT(found->front[4].error, 0.3);
}

TEST(PlaceInScene, KeepsAPowerLimit) {
  const LitFloor room;
  LightingGoal goal = room.goal_of(kThree);
  goal.watts = Eigen::VectorXd::Constant(1, 0.01);  // 18 W would be enough
  goal.max_watts = 9;
  PlaceInSceneOptions options = direct_light();
  options.lights = 3;
  const auto found = room.place(goal, options);
  ASSERT_TRUE(found);
  double watts = 0;
  for (const LightInScene& light : found->lights) watts += 0.01 * light.level;
  EXPECT_LE(watts, 9);
  EXPECT_GE(watts, 9 * 0.999) << "light is short: all of it is used";
  EXPECT_GT(found->error, 0.1);
  EXPECT_TRUE(found->front.empty());
}

}  // namespace
}  // namespace luxrig
