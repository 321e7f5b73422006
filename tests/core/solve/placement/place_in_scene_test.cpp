#include "core/solve/placement/place_in_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/core/solve/placement/mounted_room.h"

namespace luxrig {
namespace {

/// Points on the floor of the mounted room, and lux that lights off its ceiling give them, from the inverse square.
struct LitFloor {
  Scene scene = mounted_room();
  RayScene rays{scene};
  Mounting mounting = *Mounting::make(off_the_ceiling(), "rig.toml", scene, rays);
  Emitter bulb{make_isotropic(1), {}};
  std::vector<Receiver> receivers;

  LitFloor() {
    for (double y = 0.3; y < 3; y += 0.6)
      for (double x = 0.25; x < 4; x += 0.5) receivers.push_back({Vec3(x, y, 0.01), Vec3::UnitZ()});
  }
  static MountingSpec off_the_ceiling() {
    MountingSpec spec;
    spec.surfaces = {{"ceiling", {}}};
    spec.offset_min_m = 0.1;
    spec.offset_max_m = 0.3;
    spec.clearance_m = 0.2;
    return spec;
  }
  [[nodiscard]] LightingGoal goal_of(const std::vector<LightInScene>& lights) const {
    LightingGoal goal{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()))};
    for (std::size_t i = 0; i < receivers.size(); ++i)
      for (const LightInScene& light : lights) {
        const Vec3 to_m = light.position_world_m - receivers[i].position_world_m;
        goal.lux[static_cast<Eigen::Index>(i)] +=
            light.level / (4 * kPi) * to_m.z() / (to_m.squaredNorm() * to_m.norm());
      }
    return goal;
  }
  [[nodiscard]] Result<PlacedInScene> place(const LightingGoal& goal, const PlaceInSceneOptions& options) const {
    return place_in_scene(scene, rays, mounting, bulb, receivers, goal, options);
  }
};

PlaceInSceneOptions direct_light() {
  PlaceInSceneOptions options;
  options.max_level = 1e6;  // of one lumen each
  options.indirect = false;
  return options;
}

const std::vector<LightInScene> kThree = {
    {{0.8, 0.7, 2.3}, {}, 900}, {{3.1, 2.2, 2.25}, {}, 600}, {{2.2, 1.1, 2.35}, {}, 300}};

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

TEST(PlaceInScene, FindsHowManyThereAre) {
  const LitFloor room;
  const auto found = room.place(room.goal_of(kThree), direct_light());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lights.size(), 3u);
  ASSERT_GE(found->numbers.size(), 3u);
  EXPECT_GT(found->numbers[0].error, found->numbers[1].error);
  EXPECT_LE(found->numbers[2].error, 0.001);
}

TEST(PlaceInScene, HangsNoMoreThanIsWorthIt) {
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.max_lights = 5;
  options.improvement = 0.99;  // not even the second takes that much away
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  const auto found = room.place(even, options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lights.size(), 1u);
  EXPECT_GE(found->numbers.size(), 2u) << "more were looked at";
}

TEST(PlaceInScene, HangsMoreWhereOneCannotGiveEnough) {
  const LitFloor room;
  PlaceInSceneOptions options = direct_light();
  options.max_level = 250;
  options.max_lights = 4;
  const auto found = room.place(room.goal_of({{{2, 1.5, 2.3}, {}, 500}}), options);
  ASSERT_TRUE(found);
  ASSERT_GE(found->numbers.size(), 2u);
  // Half of its light leaves half of the error in its place, and a little less nearer to the floor.
  EXPECT_LE(found->numbers[0].error, 0.5);
  EXPECT_GE(found->numbers[0].error, 0.4);
  EXPECT_GE(found->lights.size(), 2u);
  for (const LightInScene& light : found->lights) EXPECT_LE(light.level, 250);
}

TEST(PlaceInScene, LightsThatLieOutsideAreSoughtAtTheEdge) {
  // What these lights give cannot be had from under the ceiling: the best is at its far offset.
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

TEST(PlaceInScene, IsTheSameForAnyNumberOfThreads) {
  const LitFloor room;
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  std::vector<PlacedInScene> found;
  for (const int threads : {1, 3}) {
    PlaceInSceneOptions options = direct_light();
    options.max_lights = 2;
    options.threads = threads;
    found.push_back(*room.place(even, options));
  }
  ASSERT_EQ(found[0].lights.size(), found[1].lights.size());
  EXPECT_EQ(found[0].error, found[1].error);
  for (std::size_t i = 0; i < found[0].lights.size(); ++i)
    EXPECT_EQ(found[0].lights[i].position_world_m, found[1].lights[i].position_world_m);
}

TEST(PlaceInScene, StoppedItGivesTheBestSoFar) {
  const LitFloor room;
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  std::stop_source stop;
  PlaceInSceneOptions options = direct_light();
  options.lights = 4;
  options.stop = stop.get_token();
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

}  // namespace
}  // namespace luxrig
