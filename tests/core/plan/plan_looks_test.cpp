// Demands of plans on heads, and on a rig with keep-out zones.
#include <gtest/gtest.h>

#include "tests/core/plan/plans.h"

namespace luxrig {
namespace {

Rig rig_with_a_head() {
  Rig rig = two_fixture_rig();
  rig.fixtures[1].moves = true;
  rig.fixtures[1].joints = {0.3, 0.4};
  rig.fixtures[1].range = {-kPi, kPi, -1, 1};
  rig.points.resize(2);
  rig.points[0].name = "desk";
  rig.points[0].goal_lx = 300;
  rig.points[1].name = "floor";
  return rig;
}

TEST(Plan, TurnsOnlyHeads) {
  const Rig rig = rig_with_a_head();
  Plan plan = plan_for_two(0.5, 0.25);
  for (PlannedLight& light : plan.tasks[0].lights) light.joints = Joints{rad_from_deg(90), rad_from_deg(-45)};
  const auto look = look_for(plan, rig, "plan.json");
  ASSERT_TRUE(look) << look.error()[0].text();
  EXPECT_EQ(look->joints[0], rig.fixtures[0].joints) << "it hangs as it hangs";
  EXPECT_DOUBLE_EQ(look->joints[1].pan_rad, rad_from_deg(90));
  EXPECT_DOUBLE_EQ(look->joints[1].tilt_rad, rad_from_deg(-45));

  // Without angles the head stays where it looks. So it does when its own angles come back from a file.
  std::optional<Joints>& joints = plan.tasks[0].lights[1].joints;
  joints.reset();
  EXPECT_EQ(look_for(plan, rig, "plan.json")->joints[1], rig.fixtures[1].joints);
  joints = rig.fixtures[1].joints;
  const auto read = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(read);
  EXPECT_TRUE(same_aim(look_for(*read, rig, "plan.json")->joints[1], rig.fixtures[1].joints));

  joints->tilt_rad = rad_from_deg(60);  // 57.3° is the end of its travel
  const auto refused = look_for(plan, rig, "plan.json");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error()[0].what.find("/tasks/0/lights/1/tilt_deg"), std::string::npos);
}

TEST(Plan, IsRefusedWhenItLightsAKeepOutZone) {
  Rig rig = rig_with_a_head();
  rig.luminaires.resize(rig.fixtures[1].luminaire + 1);
  Luminaire& luminaire = rig.luminaires[rig.fixtures[1].luminaire];
  luminaire.model = LuminaireModel::spot;
  luminaire.beam_angle_rad = rad_from_deg(10);
  luminaire.field_angle_rad = rad_from_deg(20);
  rig.keep_outs.emplace_back();
  rig.keep_outs[0].name = "stalls";
  // In its beam when it looks level along +y.
  rig.keep_outs[0].centre_world_m = rig.fixtures[1].world_from_mount.translation_m +
                                    rig.fixtures[1].world_from_mount.direction({0, 5, -5 * std::tan(rad_from_deg(40))});
  rig.keep_outs[0].radius_m = 0.3;
  rig.keep_outs[0].heads = {1};
  Plan plan = plan_for_two(0.5, 0.25);
  plan.tasks[0].lights[1].joints = Joints{0, rad_from_deg(50)};
  const auto refused = look_for(plan, rig, "plan.json");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error()[0].what,
            "/tasks: fixture \"" + rig.fixtures[1].name + "\" would light keep-out zone \"stalls\"");
  EXPECT_NE(refused.error()[0].mend.find("give it level 0"), std::string::npos);
  plan.tasks[0].lights[1].level = 0;  // it may look there in the dark
  EXPECT_TRUE(look_for(plan, rig, "plan.json"));
  plan.tasks[0].lights[1].level = 0.25;
  plan.tasks[0].lights[1].joints->tilt_rad = 0;
  EXPECT_TRUE(look_for(plan, rig, "plan.json"));
}

TEST(Plan, ZoomsHeadsThatCanZoom) {
  Rig rig = rig_with_a_head();
  rig.fixtures[1].range.beam_min_rad = rad_from_deg(10);
  rig.fixtures[1].range.beam_max_rad = rad_from_deg(50);
  rig.fixtures[1].joints.beam_rad = rad_from_deg(20);
  Plan plan = plan_for_two(0.5, 0.25);
  for (PlannedLight& light : plan.tasks[0].lights) light.joints = Joints{0, 0, rad_from_deg(45)};
  const auto again = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(again) << again.error()[0].text();
  const auto look = look_for(*again, rig, "plan.json");
  ASSERT_TRUE(look) << look.error()[0].text();
  EXPECT_EQ(look->joints[0].beam_rad, 0) << "it has no zoom";
  EXPECT_DOUBLE_EQ(look->joints[1].beam_rad, rad_from_deg(45));
  plan.tasks[0].lights[1].joints->beam_rad = 0;
  EXPECT_EQ(look_for(plan, rig, "plan.json")->joints[1].beam_rad, rig.fixtures[1].joints.beam_rad);
  plan.tasks[0].lights[1].joints->beam_rad = rad_from_deg(51);
  const auto refused = look_for(plan, rig, "plan.json");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error()[0].what.find("/tasks/0/lights/1/beam_angle_deg"), std::string::npos);
}

// An aim's levels are its own. A later emittance task uses goals again, which are the plan's.
TEST(Plan, KeepsTheLookOfAnAimUnlessLevelsAreSetAfterIt) {
  const Rig rig = rig_with_a_head();
  Plan plan = plan_for_two(0.5, 0.25);
  for (const auto& [name, lux] : {std::pair("desk", 120.0), std::pair("floor", 35.0)}) {
    PlannedPoint point;
    point.name = name;
    point.lux = lux;
    plan.points.push_back(point);
  }
  plan.points[0].goal_lux = 250;
  EXPECT_EQ(look_for(plan, rig, "plan.json")->goal_lx[0], 250) << "the rig file says 300";
  EXPECT_FALSE(look_for(plan, rig, "plan.json")->goal_lx[1]);
  plan.tasks.push_back(plan.tasks[0]);
  plan.tasks[1].kind = "aim";
  EXPECT_TRUE(holds_a_look(plan));
  EXPECT_EQ(look_for(plan, rig, "plan.json")->goal_lx[0], 120);
  EXPECT_EQ(look_for(plan, rig, "plan.json")->goal_lx[1], 35);
  plan.tasks.push_back(plan.tasks[0]);
  EXPECT_FALSE(holds_a_look(plan));
  EXPECT_EQ(look_for(plan, rig, "plan.json")->goal_lx[0], 250);
}

TEST(Plan, CarriesItsGoalsWeightsAndLimitsAndAppliesTheLowerLimit) {
  Rig rig = rig_with_a_head();
  rig.points[0].max_lx = 400;
  rig.points[0].weight = 2;
  Plan plan = plan_for_two(0.5, 0.25);
  EXPECT_FALSE(look_for(plan, rig, "plan.json")->goal_lx[0]) << "a plan without goals is corrected towards none";
  EXPECT_EQ(look_for(plan, rig, "plan.json")->max_lx[0], 400);
  PlannedPoint point;
  point.name = "desk";
  point.goal_lux = 150;
  point.weight = 3;
  point.max_lux = 200;
  plan.points.push_back(point);
  const auto again = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(again);
  const auto look = look_for(*again, rig, "plan.json");
  ASSERT_TRUE(look);
  EXPECT_EQ(look->goal_lx[0], 150);
  EXPECT_EQ(look->weight[0], 3);
  EXPECT_EQ(look->max_lx[0], 200);
  plan.points[0].max_lux = 900;
  EXPECT_EQ(look_for(plan, rig, "plan.json")->max_lx[0], 400) << "a plan cannot raise the rig's limit";
  plan.points[0].goal_lux = -1;
  const auto refused = look_for(plan, rig, "plan.json");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error()[0].what, "/points/0/goal_lux: -1 for point \"desk\"");
  plan.points[0].goal_lux = 150;
  plan.points[0].weight.reset();
  EXPECT_EQ(look_for(plan, rig, "plan.json")->weight[0], 2);
}

TEST(Plan, DistinguishesLevelsSetByHandFromSolvedOnes) {
  const Rig rig = rig_with_a_head();
  Plan plan = plan_for_two(0.05, 0.25);
  plan.tasks[0].lights[1].solved_level = 0.25;
  EXPECT_FALSE(look_for(plan, rig, "plan.json")->solved_levels[0]) << "nobody knows what was solved";
  plan.tasks[0].lights[0].solved_level = 0.5;
  const auto again = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(again);
  const auto look = look_for(*again, rig, "plan.json");
  ASSERT_TRUE(look);
  EXPECT_EQ(look->levels[0], 0.05);
  EXPECT_EQ(look->solved_levels[0], 0.5);
  EXPECT_FALSE(look->solved_levels[1]);
}

TEST(Plan, NamesThePartsOfTheRigThatHaveChanged) {
  Plan plan = plan_for_two(0.5, 0.25);
  plan.made_for = RigVersion{0xfedcba9876543210U, 2, 3};
  const auto again = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(again);
  ASSERT_TRUE(again->made_for);
  EXPECT_EQ(*again->made_for, *plan.made_for);
  EXPECT_EQ(what_differs(*plan.made_for, *again->made_for), "");
  EXPECT_EQ(what_differs(*plan.made_for, {1, 2, 3}), "goals");
  EXPECT_EQ(what_differs(*plan.made_for, {1, 1, 1}), "goals, limits, scene, photometry or places");
  for (const char* wrong : {R"("made_for": 3)", R"("made_for": {"goals": "xyz"})", R"("made_for": {"goals": 4})"})
    EXPECT_FALSE(plan_from_json(std::string(R"({"luxrig_plan": 1, "rig": "room", "tasks": [], )") + wrong + "}", "p"))
        << wrong;
}

}  // namespace
}  // namespace luxrig
