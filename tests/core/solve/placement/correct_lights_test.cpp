#include "core/solve/placement/search/correct_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/solve/placement/search/refine_lights.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

/// The better model: every light gives a tenth more lux than in the quick model, plus some lux that varies smoothly
/// with its place.
LuxOfLights better_lux(const LitHall& hall) {
  return [&hall](std::span<const LightPose> poses, const Eigen::VectorXd& levels) -> Result<Eigen::VectorXd> {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(hall.light->points()), lux;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const double level = levels[static_cast<Eigen::Index>(k)];
      EXPECT_TRUE(hall.light->column(poses[k], lux, nullptr));
      all += 1.1 * level * lux;
      all.array() += level * 0.0004 * (3 + std::sin(poses[k].position_world_m.x()));
    }
    return all;
  };
}

TEST(CorrectLights, BringsAQuickModelToABetterOnesResult) {
  LitRoom empty = make_box_room(3);  // no shadows, so refining is enough
  empty.scene = {};
  const LitHall hall(empty, 10);
  const std::vector<LightPose> known = {{{0.9, 0.8, 2.1}}, {{3.1, 2.2, 1.9}}};
  const Eigen::Vector2d levels(800, 500);
  const LuxOfLights lux_of = better_lux(hall);
  LightingGoal goal;
  goal.lux = *lux_of(known, levels);
  PlacedLights quick(*hall.light, goal);
  for (const LightPose& pose : known) ASSERT_TRUE(quick.add({pose.position_world_m + Vec3(0.1, -0.1, 0.05)}));
  refine_lights(quick);
  const double before = (*lux_of(quick.poses(), quick.levels()) - goal.lux).norm() / goal.lux.norm();
  CorrectOptions rounds;
  rounds.max_rounds = 12;
  const auto corrected = correct_lights(
      *hall.light, goal, quick, lux_of,
      [](const LightingGoal&, const PlacedLights& start) {
        PlacedLights lights = start;
        refine_lights(lights);
        return lights;
      },
      rounds);
  ASSERT_TRUE(corrected);
  EXPECT_GT(before, 0.02);
  EXPECT_LE(corrected->error, 0.002);
  EXPECT_LE((corrected->lux - goal.lux).norm(), 0.002 * goal.lux.norm());
  for (const LightPose& pose : known) {
    double nearest_m = 1e9;
    for (const LightPose& at : corrected->lights.poses())
      nearest_m = std::min(nearest_m, (at.position_world_m - pose.position_world_m).norm());
    EXPECT_LE(nearest_m, 0.03);
  }
}

TEST(CorrectLights, ReturnsTheLightsUnchangedWhenNothingIsBetter) {
  const LitHall hall(make_box_room(3), 0.5);
  const LuxOfLights lux_of = better_lux(hall);
  LightingGoal goal;
  goal.lux = *lux_of(std::vector<LightPose>{{{2, 1.5, 2}}}, Eigen::VectorXd::Constant(1, 300));
  PlacedLights lights(*hall.light, goal);
  ASSERT_TRUE(lights.add({{2, 1.5, 2.1}}));
  // A search that makes everything worse.
  const auto corrected =
      correct_lights(*hall.light, goal, lights, lux_of, [](const LightingGoal&, const PlacedLights& start) {
        PlacedLights worse = start;
        worse.replace(0, {{0.4, 0.4, 0.5}});
        return worse;
      });
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->lights.poses(), lights.poses());
  const auto failed = correct_lights(
      *hall.light, goal, lights,
      [](std::span<const LightPose>, const Eigen::VectorXd&) -> Result<Eigen::VectorXd> {
        return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
      },
      [](const LightingGoal&, const PlacedLights& start) { return start; });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().cause, Cause::cancelled);
}

}  // namespace
}  // namespace luxrig
