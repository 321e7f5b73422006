/// Relief tasks by what is seen.
#include <gtest/gtest.h>

#include "tests/core/tasks/relief_tasks_fixture.h"

namespace luxrig {
namespace {

using namespace relief_tasks_fixture;

const std::string kSeenAim = replaced(kAim, "contrast = \"lux\"", "objective = \"seen\"");

TEST_F(AimTask, BringsOutWhatIsSeen) {
  const SolvedTasks solved = solved_of(well(std::string(kWellRig) + kSeenAim), direct_light());
  const PlannedRelief& relief = *solved.plan.tasks[0].relief;
  ASSERT_TRUE(relief.seen && relief.before_seen && relief.lit_share && relief.clipped_share);
  EXPECT_GT(*relief.seen, *relief.before_seen);
  EXPECT_GT(*relief.lit_share, 0.5);
  EXPECT_GT(relief.object_lux, 100);
  // The thesis's objective says nothing about it.
  const SolvedTasks thesis = solved_of(well(std::string(kWellRig) + kAim), direct_light());
  EXPECT_FALSE(thesis.plan.tasks[0].relief->seen);
}

TEST_F(AimTask, KeepsTheObjectsLimitByWhatIsSeenAndIsAsBrightAsItMayBe) {
  const SolvedTasks solved =
      solved_of(well(std::string(kWellRig) + kSeenAim + "max_object_lx = 120\n"), direct_light());
  const PlannedRelief& relief = *solved.plan.tasks[0].relief;
  EXPECT_LE(relief.object_lux, 120 * (1 + 1e-9));
  EXPECT_GT(relief.object_lux, 0.9 * 120);
  EXPECT_GT(*relief.lit_share, 0.5);
}

// A dark room gives nothing back; a white ceiling does.
TEST_F(AimTask, ReflectedLightFillsWhatIsSeen) {
  const std::string rig = std::string(kWellRig) + kSeenAim;
  ComputeOptions all;
  all.max_error = 0.1;
  const Session session = well(rig);
  const SolvedTasks direct = solved_of(session, direct_light()), filled = solved_of(session, all);
  EXPECT_LE(*filled.plan.tasks[0].relief->clipped_share, *direct.plan.tasks[0].relief->clipped_share + 0.02);
}

// Both heads have a warm and a cool emitter.
TEST_F(AimTask, MixesTheWantedColourOfItsEmitters) {
  std::string rig = replaced(kWellRig, "lumens = 800\nwatts = 10\n",
                             "[[luminaire.emitters]]\nname = \"warm\"\nlumens = 400\ncct_k = 2700\n"
                             "[[luminaire.emitters]]\nname = \"cool\"\nlumens = 400\ncct_k = 6500\n");
  for (const char* slots : {"1\nslots", "11\nslots"})
    rig = replaced(rig, std::string(slots) + " = [\"pan\", \"tilt\", \"dimmer\"]",
                   std::string(slots) + " = [\"pan\", \"tilt\", \"emitter:warm\", \"emitter:cool\"]");
  const auto levels = [&](const std::string& key) {
    return levels_of(solved_of(well(rig + kSeenAim + key), direct_light()));
  };
  const Eigen::VectorXd alike = levels(""), warm = levels("cct_k = 2700\n"), between = levels("cct_k = 4000\n");
  for (Eigen::Index head = 0; head < 4; head += 2) {
    EXPECT_EQ(alike[head], alike[head + 1]);
    EXPECT_NEAR(warm[head + 1], 0, 1e-9);
    if (!(between[head] > 0)) continue;
    const double mixed = between[head + 1] / between[head];
    EXPECT_GT(mixed, 0.5);
    EXPECT_LT(mixed, 2);
  }
  EXPECT_GT(warm.maxCoeff(), 0.1);
  EXPECT_GT(between.maxCoeff(), 0.1);
  const Session orange = well(rig + kSeenAim + "cct_k = 1700\n");
  const auto refused = solve_tasks(orange, transport_of(orange, direct_light()), direct_light());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("cannot give light of this cct_k"), std::string::npos)
      << refused.error().detail;
}

TEST_F(HighlightTask, ChoosesPlacesByWhatIsSeen) {
  const std::string seen = replaced(kHighlight, "object = \"slab\"", "object = \"slab\"\nobjective = \"seen\"");
  const SolvedTasks solved = solved_of(well(std::string(kWellRig) + seen), direct_light());
  const PlannedTask& task = solved.plan.tasks[0];
  ASSERT_TRUE(task.relief->seen);
  EXPECT_GT(*task.relief->lit_share, 0.5);
  ASSERT_GE(task.lights.size(), 1u);
  ASSERT_LE(task.lights.size(), 2u);
  for (const PlannedLight& light : task.lights) {
    EXPECT_GT(light.position_world_m.z(), 2.7);
    EXPECT_LT(light.position_world_m.z(), 3);
  }
}

}  // namespace
}  // namespace luxrig
