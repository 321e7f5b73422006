/// place_lights: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/solve/placement/place_lights.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

/// Largest distance from one of these places to its nearest light.
double farthest_off_m(const std::vector<Vec3>& places_m, const PlacedLights& lights) {
  double farthest_m = 0;
  for (const Vec3& place_m : places_m) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const LightPose& pose : lights.poses())
      nearest_m = std::min(nearest_m, (pose.position_world_m - place_m).norm());
    farthest_m = std::max(farthest_m, nearest_m);
  }
  return farthest_m;
}

TEST(PlaceLights, FindsKnownLightsOfAFurnishedRoom) {
  const LitHall hall(make_box_room(3), 0.25);
  const std::vector<Vec3> places_m = {{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}, {2.2, 1.4, 2.3}};
  const LightingGoal goal = hall.goal_of(places_m, {800, 500, 300});
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  PlaceOptions options;
  options.lights = 3;
  const Placement got = place_lights(*hall.light, goal, candidates, options);
  EXPECT_LE(got.lights.error(), 1e-4);
  EXPECT_LE(farthest_off_m(places_m, got.lights), 0.01);
}

TEST(PlaceLights, AgreesWithTheTenLampsOfAFlat) {
  const LitRoom flat = make_eight_room_flat(2);
  std::vector<Vec3> places_m;
  std::vector<double> levels;
  for (const Emitter& lamp : flat.emitters) {
    places_m.push_back(lamp.world_from_lamp.translation_m);
    levels.push_back(lamp.intensity->flux_lm());
  }
  const LitHall hall(flat, 0.25);
  const LightingGoal goal = hall.goal_of(places_m, levels);
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  PlaceOptions options;
  options.lights = 10;
  const Placement got = place_lights(*hall.light, goal, candidates, options);
  EXPECT_LE(got.lights.error(), 0.002);
  EXPECT_LE(farthest_off_m(places_m, got.lights), 0.03);
}

TEST(PlaceLights, TriesASecondStartForAHardGoalAndKeepsTheBetter) {
  const LitHall hall(make_eight_room_flat(2), 0.6);
  const LightingGoal even{Eigen::VectorXd::Constant(hall.light->points(), 200)};
  const ComplementSearch candidates(hall.view(), hall.poses, even);
  PlaceOptions options;
  options.lights = 6;
  options.max_columns = 1500;
  options.exchange.complements = 1;
  options.exchange.near_places = 0;
  const Placement alone = place_lights(*hall.light, even, candidates, options);
  ASSERT_GT(alone.lights.error(), kHardGoalError);
  int asked = 0;
  std::vector<LightPose> many;
  options.other = [&](std::size_t lights, std::uint64_t) {
    EXPECT_EQ(lights, 6u);
    ++asked;
    return many;
  };
  // Useless proposals: none; a duplicate together with a place where no light may hang.
  const LightPose nowhere{{1e4, 0, 0}};
  for (const std::vector<LightPose>& useless :
       {std::vector<LightPose>{}, {hall.poses.front(), hall.poses.front(), nowhere}}) {
    many = useless;
    const Placement got = place_lights(*hall.light, even, candidates, options);
    EXPECT_EQ(got.lights.size(), 6u);
    EXPECT_LE(got.lights.error(), 1.1 * alone.lights.error());
  }
  EXPECT_GE(asked, 2);
  // A useful proposal: better lights than the first start ends with, plus two that are not needed.
  PlaceOptions patient = options;
  patient.other = {};
  patient.max_columns = 3000;
  patient.exchange = {};
  const Placement better = place_lights(*hall.light, even, candidates, patient);
  ASSERT_LT(better.lights.error(), 0.99 * alone.lights.error());
  many = better.lights.poses();
  many.push_back(hall.poses.front());
  many.push_back(hall.poses.back());
  const Placement helped = place_lights(*hall.light, even, candidates, options);
  EXPECT_LE(helped.lights.error(), 1.001 * better.lights.error());
}

}  // namespace
}  // namespace luxrig
