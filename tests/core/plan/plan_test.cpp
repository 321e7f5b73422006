#include "core/plan/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/core/plan/plans.h"

namespace luxrig {
namespace {

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool same(const Vec3& a, const Vec3& b) { return same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z()); }

void expect_same(const Plan& a, const Plan& b) {
  EXPECT_EQ(a.rig, b.rig);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_TRUE(same(a.seconds, b.seconds));
  ASSERT_EQ(a.tasks.size(), b.tasks.size());
  for (std::size_t t = 0; t < a.tasks.size(); ++t) {
    EXPECT_EQ(a.tasks[t].name, b.tasks[t].name);
    EXPECT_EQ(a.tasks[t].kind, b.tasks[t].kind);
    EXPECT_EQ(a.tasks[t].iterations, b.tasks[t].iterations);
    EXPECT_TRUE(same(a.tasks[t].normalised_error, b.tasks[t].normalised_error));
    ASSERT_EQ(a.tasks[t].lights.size(), b.tasks[t].lights.size());
    for (std::size_t l = 0; l < a.tasks[t].lights.size(); ++l) {
      const PlannedLight &x = a.tasks[t].lights[l], &y = b.tasks[t].lights[l];
      EXPECT_EQ(x.name, y.name);
      EXPECT_EQ(x.luminaire, y.luminaire);
      EXPECT_TRUE(same(x.position_world_m, y.position_world_m));
      ASSERT_EQ(x.aim_world_m.has_value(), y.aim_world_m.has_value());
      EXPECT_TRUE(!x.aim_world_m || same(*x.aim_world_m, *y.aim_world_m));
      ASSERT_EQ(x.joints.has_value(), y.joints.has_value());
      if (x.joints) EXPECT_TRUE(same_aim(*x.joints, *y.joints));
      EXPECT_TRUE(same(x.level, y.level));
      EXPECT_TRUE(same(x.lumens, y.lumens));
    }
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t p = 0; p < a.points.size(); ++p) {
    EXPECT_EQ(a.points[p].name, b.points[p].name);
    EXPECT_TRUE(same(a.points[p].position_world_m, b.points[p].position_world_m));
    EXPECT_TRUE(same(a.points[p].normal_world, b.points[p].normal_world));
    EXPECT_TRUE(same(a.points[p].lux, b.points[p].lux));
    EXPECT_TRUE(same(a.points[p].direct_lux, b.points[p].direct_lux));
    EXPECT_TRUE(same(a.points[p].standard_error_lux, b.points[p].standard_error_lux));
    EXPECT_EQ(a.points[p].goal_lux, b.points[p].goal_lux);
    EXPECT_EQ(a.points[p].why, b.points[p].why);
    EXPECT_EQ(a.points[p].verdict, b.points[p].verdict);
    EXPECT_EQ(a.points[p].reason, b.points[p].reason);
    EXPECT_EQ(a.points[p].daylight_lux, b.points[p].daylight_lux);
    EXPECT_EQ(a.points[p].opening_lux, b.points[p].opening_lux);
    EXPECT_EQ(a.points[p].goal_tolerance, b.points[p].goal_tolerance);
  }
  ASSERT_EQ(a.limits.size(), b.limits.size());
  for (std::size_t l = 0; l < a.limits.size(); ++l) {
    EXPECT_EQ(a.limits[l].point, b.limits[l].point);
    EXPECT_TRUE(same(a.limits[l].max_lux, b.limits[l].max_lux));
    EXPECT_TRUE(same(a.limits[l].lux, b.limits[l].lux));
    EXPECT_EQ(a.limits[l].met, b.limits[l].met);
  }
}

Plan random_plan(std::mt19937_64& random) {
  const auto number = [&] {
    std::uniform_real_distribution<double> exponent(-300, 300), mantissa(-1, 1);
    return mantissa(random) * std::pow(10, exponent(random));
  };
  std::uniform_real_distribution<double> angle_rad(-20, 20);
  const auto vector = [&] { return Vec3(number(), number(), number()); };
  const auto coin = [&] { return random() % 2 == 0; };
  Plan plan;
  plan.rig = "a \"rig\" in \\ Zürich\n";
  plan.seed = random();
  plan.seconds = number();
  for (std::uint64_t t = 0; t < random() % 3; ++t) {
    PlannedTask task{"task", "emittance", number(), static_cast<int>(random() % 1000), number(), {}};
    for (std::uint64_t l = 0; l < random() % 5; ++l) {
      PlannedLight made{"spot-" + std::to_string(l), "narrow", vector(), {}, {}, number()};
      made.lumens = number();
      if (coin()) made.aim_world_m = vector();
      if (coin()) made.joints = Joints{angle_rad(random), angle_rad(random), coin() ? 0.3 : 0.0};
      task.lights.push_back(made);
    }
    plan.tasks.push_back(task);
  }
  for (std::uint64_t p = 0; p < random() % 5; ++p) {
    PlannedPoint point{"p", vector(), vector(), number(), number(), number(), {}, coin() ? "a limit binds" : ""};
    if (coin()) point.goal_lux = number();
    if (coin()) point.daylight_lux = number();
    if (coin()) point.opening_lux = number();
    if (coin()) point.goal_tolerance = number();
    plan.points.push_back(point);
  }
  for (std::uint64_t l = 0; l < random() % 3; ++l) plan.limits.push_back({"p", number(), number(), coin()});
  return plan;
}

TEST(Plan, RoundTripsEveryBit) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    const Plan plan = random_plan(random);
    const auto read = plan_from_json(to_json(plan), "plan.json");
    ASSERT_TRUE(read) << read.error()[0].text();
    expect_same(plan, *read);
    EXPECT_EQ(to_json(*read), to_json(plan));
  }
}

TEST(Plan, HasTheKeysOfTheContractInTheirOrder) {
  Plan plan;
  plan.rig = "room";
  plan.seed = 7;
  plan.seconds = 0.5;
  PlannedLight spot = light("spot-1", 0.25);
  spot.luminaire = "narrow";
  spot.aim_world_m = Vec3(1, 2, 3);
  spot.joints = Joints{rad_from_deg(10), rad_from_deg(20)};
  spot.lumens = 225;
  plan.tasks = {{"levels", "emittance", 0.125, 3, 0.25, {spot}}};
  plan.points = {{"desk", Vec3(0, 0, 1), Vec3(0, 0, 1), 300, 200, 1.5, 310, "why"}};
  plan.limits = {{"desk", 400, 300, true}};
  std::string text = to_json(plan);
  std::erase_if(text, [](char c) { return c == '\n' || c == ' '; });
  EXPECT_EQ(text,
            R"({"luxrig_plan":1,"rig":"room","tasks":[{"name":"levels","kind":"emittance","normalised_error":0.125,)"
            R"("iterations":3,"seconds":0.25,"lights":[{"name":"spot-1","luminaire":"narrow",)"
            R"("position":[0.0,0.0,0.0],"aim":[1.0,2.0,3.0],"pan_deg":10.0,"tilt_deg":20.0,"level":0.25,)"
            R"("lumens":225.0}]}],"points":[{"name":"desk","position":[0.0,0.0,1.0],"normal":[0.0,0.0,1.0],)"
            R"("lux":300.0,"direct_lux":200.0,"standard_error_lux":1.5,"goal_lux":310.0,"why":"why"}],)"
            R"("limits":[{"point":"desk","max_lux":400.0,"lux":300.0,"met":true}],"seconds":0.5,"seed":7})");
}

TEST(Plan, OmitsNonFiniteNumbers) {
  Plan plan = plan_for_two(0.5, 0.5);
  plan.seconds = std::numeric_limits<double>::infinity();
  plan.points.emplace_back();
  plan.points[0].name = "p";
  plan.points[0].lux = std::nan("");
  plan.points[0].goal_lux = std::nan("");
  const std::string text = to_json(plan);
  EXPECT_EQ(text.find("null"), std::string::npos);
  EXPECT_EQ(text.find("\"lux\""), std::string::npos);
  EXPECT_EQ(text.find("goal_lux"), std::string::npos);
  const auto read = plan_from_json(text, "plan.json");
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::isnan(read->points[0].lux));
  EXPECT_TRUE(std::isnan(read->seconds));
  EXPECT_FALSE(read->points[0].goal_lux);
}

TEST(Plan, WritesANonUtf8NameWithoutThrowing) {
  Plan plan = plan_for_two(0, 0);
  plan.tasks[0].name = "\xff\xfe";
  EXPECT_TRUE(plan_from_json(to_json(plan), "plan.json"));
}

TEST(Plan, PointsAtTheLineAndColumnOfASyntaxError) {
  const auto read = plan_from_json("{\n \"luxrig_plan\": 1,\n \"rig\": }", "my.json");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error()[0].text().rfind("my.json:3:9: ", 0), 0u) << read.error()[0].text();
  const auto large = plan_from_json("{\n \"luxrig_plan\": 1e999}", "my.json");
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error()[0].line, 2) << large.error()[0].text();
  EXPECT_NE(large.error()[0].what.find("1e999"), std::string::npos);
}

TEST(Plan, PointsAtTheLineAndColumnOfAWrongEntry) {
  const auto read = plan_from_json(
      "{\n \"luxrig_plan\": 1,\n \"rig\": \"a \\\" {[,\",\n \"tasks\": [{\"name\": \"t\", \"lights\": [{\"name\": "
      "\"l\", "
      "\"level\": 1},\n  {\"name\": \"m\",\n   \"level\": \"full\"},\n  {\"level\": 1}]}]}",
      "my.json");
  ASSERT_FALSE(read);
  ASSERT_EQ(read.error().size(), 2u);
  EXPECT_EQ(read.error()[0].text().rfind("my.json:6:13: /tasks/0/lights/1/level is \"full\"", 0), 0u)
      << read.error()[0].text();
  EXPECT_EQ(read.error()[1].text().rfind("my.json:7:3: /tasks/0/lights/2/name is missing", 0), 0u)
      << read.error()[1].text();
  const auto list = plan_from_json("\n[1]", "my.json");
  ASSERT_FALSE(list);
}

TEST(Plan, NamesThePathOfEveryWrongEntry) {
  const auto read = plan_from_json(
      R"({"luxrig_plan":1,"rig":"room","seed":-1,"tasks":[{"name":"t","lights":[{"name":"left","level":"full"},3,)"
      R"({"name":7,"level":1,"position":[1,2]}]}],"points":{},"limits":[{"point":"p","met":1}]})",
      "my.json");
  ASSERT_FALSE(read);
  std::string all;
  for (const Problem& problem : read.error()) {
    EXPECT_FALSE(problem.mend.empty());
    all += problem.text() + "\n";
  }
  for (const char* path : {"/seed is -1", "/tasks/0/lights/0/level is \"full\"", "/tasks/0/lights/1 is number",
                           "/tasks/0/lights/2/name is 7", "/tasks/0/lights/2/position is array", "/points is object",
                           "/limits/0/met is 1"}) {
    EXPECT_NE(all.find(path), std::string::npos) << path << " in\n" << all;
  }
}

TEST(Plan, RefusesHostileText) {
  const std::string deep(100000, '[');
  const std::string bad[] = {
      "",
      " ",
      "null",
      "[]",
      "1",
      "\"plan\"",
      "{}",
      "{",
      deep,
      std::string("\0\0", 2),
      "\xff\xfe{}",
      R"({"luxrig_plan":2,"rig":"r","tasks":[]})",
      R"({"luxrig_plan":"1","rig":"r","tasks":[]})",
      R"({"luxrig_plan":1,"rig":null,"tasks":[]})",
      R"({"luxrig_plan":1,"rig":"r"})",
      R"({"luxrig_plan":1,"rig":"r","rig":"s","tasks":[]})",
      R"({"luxrig_plan":1,"rig":"r","tasks":[]} trailing)",
      R"({"luxrig_plan":1,"rig":"r","tasks":[],"seed":1.5})",
      R"({"luxrig_plan":1,"rig":"r","tasks":[],"seed":99999999999999999999})",
      R"({"luxrig_plan":1,"rig":"r","tasks":[{"name":"t","iterations":3000000000,"lights":[]}]})",
      R"({"luxrig_plan":1,"rig":"r","tasks":[{"name":"t","lights":[{"name":"x"}]}]})"};
  for (const std::string& text : bad) {
    const auto read = plan_from_json(text, "bad.json");
    ASSERT_FALSE(read) << text.substr(0, 80);
    ASSERT_FALSE(read.error().empty());
    EXPECT_FALSE(read.error()[0].what.empty());
    EXPECT_FALSE(read.error()[0].mend.empty());
  }
}

TEST(Plan, RefusesMoreValuesThanItsMemoryBound) {
  std::string many = "[0";
  for (int i = 0; i < 2'000'000; ++i) many += ",0";
  const auto values = plan_from_json(many + "]", "bad.json");
  ASSERT_FALSE(values);
  EXPECT_NE(values.error()[0].what.find("more than 2000000 values"), std::string::npos) << values.error()[0].text();
  std::string keys = "{\"k\":0";
  for (int i = 0; i < 1000; ++i) keys += ",\"" + std::to_string(i) + "\":0";
  const auto object = plan_from_json(keys + "}", "bad.json");
  ASSERT_FALSE(object);
  EXPECT_NE(object.error()[0].what.find("more than 1000 keys"), std::string::npos) << object.error()[0].text();
}

TEST(Plan, IgnoresKeysOfLaterVersions) {
  EXPECT_TRUE(plan_from_json(R"({"luxrig_plan":1,"rig":"r","tasks":[{"name":"t","lights":[],"coverage":1}],"new":{}})",
                             "plan.json"));
}

TEST(Plan, GivesTheLevelsInTheRigsOrder) {
  Plan plan = plan_for_two(0.25, 0.5);
  std::swap(plan.tasks[0].lights[0], plan.tasks[0].lights[1]);
  const auto levels = levels_for(plan, two_fixture_rig(), "plan.json");
  ASSERT_TRUE(levels);
  EXPECT_EQ(*levels, (std::vector<double>{0.25, 0.5}));
}

TEST(Plan, UsesTheLastTaskThatNamesAFixture) {
  Plan plan = plan_for_two(0.25, 0.5);
  plan.tasks.push_back({.name = "more", .kind = "emittance", .lights = {light("left", 0.75)}});
  const auto levels = levels_for(plan, two_fixture_rig(), "plan.json");
  ASSERT_TRUE(levels);
  EXPECT_EQ(*levels, (std::vector<double>{0.75, 0.5}));
}

TEST(Plan, IsRefusedForAnotherRigOrWithImpossibleLevels) {
  const Rig rig = two_fixture_rig();
  Plan other = plan_for_two(0.5, 0.5);
  other.rig = "hall";
  Plan unknown = plan_for_two(0.5, 0.5);
  unknown.tasks[0].lights.push_back(light("middle", 0));
  Plan missing = plan_for_two(0.5, 0.5);
  missing.tasks[0].lights.pop_back();
  Plan twice = plan_for_two(0.5, 0.5);
  twice.tasks[0].lights.push_back(light("left", 0.5));
  const struct {
    Plan plan;
    const char* says;
  } cases[] = {{other, "\"hall\""},
               {unknown, "\"middle\""},
               {missing, "\"right\""},
               {twice, "twice"},
               {plan_for_two(-0.1, 0), "/tasks/0/lights/0/level"},
               {plan_for_two(1.01, 0), "/tasks/0/lights/0/level"},
               {plan_for_two(0, 0.91), "/tasks/0/lights/1/level"},
               {plan_for_two(std::nan(""), 0), "/tasks/0/lights/0/level"}};
  for (const auto& bad : cases) {
    const auto levels = levels_for(bad.plan, rig, "plan.json");
    ASSERT_FALSE(levels) << bad.says;
    EXPECT_NE(levels.error()[0].what.find(bad.says), std::string::npos) << levels.error()[0].text();
  }
  Rig limited = rig;
  limited.limits.max_level = 0.4;
  EXPECT_FALSE(levels_for(plan_for_two(0.5, 0.3), limited, "plan.json"));
  EXPECT_TRUE(levels_for(plan_for_two(0.4, 0.4), limited, "plan.json"));
}

/// "left" and "right" at these levels, and a bulb not hung yet.
Plan plan_that_places() {
  Plan plan = plan_for_two(0.25, 0.5);
  PlannedLight placed = light("more 1", 0.75);
  placed.luminaire = "bulb";
  placed.position_world_m = Vec3(1, 2, 2.5);
  placed.aim_world_m = Vec3(1, 3, 2.5);
  plan.tasks.push_back({.name = "more", .kind = "placement", .lights = {placed}});
  plan.tasks.back().fixtures = {light("left", 0.25), light("right", 0)};
  plan.tasks.back().numbers = {{1, 0.5}, {2, 0.25}};
  plan.tasks.back().lower_bound = 0.0625;
  plan.tasks.back().lower_bound_of_number = 0.125;
  plan.tasks.back().switches_proven = false;
  return plan;
}

Rig rig_with_a_bulb() {
  Rig rig = two_fixture_rig();
  rig.buses.resize(1);
  rig.luminaires.resize(2);
  rig.luminaires[1].name = "bulb";
  return rig;
}

TEST(Plan, KeepsTheResultOfAPlacement) {
  const Plan plan = plan_that_places();
  const auto read = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(read);
  expect_same(plan, *read);
  ASSERT_EQ(read->tasks[1].fixtures.size(), 2u);
  EXPECT_EQ(read->tasks[1].fixtures[0].name, "left");
  EXPECT_EQ(read->tasks[1].fixtures[0].level, 0.25);
  ASSERT_EQ(read->tasks[1].numbers.size(), 2u);
  EXPECT_EQ(read->tasks[1].numbers[1].lights, 2);
  EXPECT_EQ(read->tasks[1].numbers[1].normalised_error, 0.25);
  EXPECT_EQ(read->tasks[1].lower_bound, 0.0625);
  EXPECT_EQ(read->tasks[1].lower_bound_of_number, 0.125);
  EXPECT_FALSE(read->tasks[1].switches_proven);
  EXPECT_TRUE(read->tasks[0].switches_proven);
  EXPECT_FALSE(read->tasks[0].lower_bound);
}

TEST(Plan, IsRefusedWithARemedyWhileItsLightsAreUnhung) {
  const auto levels = levels_for(plan_that_places(), rig_with_a_bulb(), "plan.json");
  ASSERT_FALSE(levels);
  ASSERT_EQ(levels.error().size(), 1u);
  EXPECT_EQ(levels.error()[0].what, "/tasks/1/lights/0/name: light \"more 1\" does not hang yet");
  for (const char* part : {"hang a bulb at [1.000, 2.000, 2.500]", "[[fixture]]", "\"more 1\""})
    EXPECT_NE(levels.error()[0].mend.find(part), std::string::npos) << levels.error()[0].mend;
}

TEST(Plan, SetsAPlacedLightOnceItHangs) {
  Rig rig = rig_with_a_bulb();
  rig.fixtures.push_back(rig.fixtures[0]);
  rig.fixtures[2].name = "more 1";
  const auto levels = levels_for(plan_that_places(), rig, "plan.json");
  ASSERT_TRUE(levels);
  EXPECT_EQ(*levels, (std::vector<double>{0.25, 0, 0.75})) << "fixtures as they were meanwhile";
  const auto in_model = hang_plan(plan_that_places(), rig, "plan.json");
  ASSERT_TRUE(in_model);
  EXPECT_EQ(in_model->rig.fixtures.size(), 3u) << "nothing is hung twice";
}

TEST(Plan, HangsPlacedLightsInTheModel) {
  const Rig rig = rig_with_a_bulb();
  const auto in_model = hang_plan(plan_that_places(), rig, "plan.json");
  ASSERT_TRUE(in_model);
  EXPECT_EQ(in_model->look.levels, (std::vector<double>{0.25, 0, 0.75}));
  ASSERT_EQ(in_model->rig.fixtures.size(), 3u);
  ASSERT_EQ(in_model->look.joints.size(), 3u);
  const Fixture& hung = in_model->rig.fixtures[2];
  EXPECT_EQ(in_model->look.joints[2], hung.joints);
  EXPECT_EQ(hung.name, "more 1");
  EXPECT_EQ(hung.luminaire, 1u);
  EXPECT_EQ(hung.bus, rig.buses.size()) << "it has none";
  const Pose pose = hung.world_from_lamp();
  EXPECT_EQ(pose.translation_m, Vec3(1, 2, 2.5));
  EXPECT_LE((pose.rotation * Vec3(0, 0, -1) - Vec3(0, 1, 0)).norm(), 1e-12);
}

TEST(Plan, RefusesToHangInvalidLights) {
  Plan unknown = plan_that_places(), nowhere = plan_that_places(), bright = plan_that_places(),
       itself = plan_that_places(), levels_task = plan_that_places();
  unknown.tasks[1].lights[0].luminaire = "blub";
  nowhere.tasks[1].lights[0].position_world_m.setConstant(std::nan(""));
  bright.tasks[1].lights[0].level = 1.2;
  itself.tasks[1].lights[0].aim_world_m = itself.tasks[1].lights[0].position_world_m;
  levels_task.tasks[1].kind = "emittance";
  const struct {
    Plan plan;
    const char* says;
  } cases[] = {{unknown, "no luminaire \"blub\""},
               {nowhere, "/tasks/1/lights/0/position"},
               {bright, "/tasks/1/lights/0/level"},
               {itself, "/tasks/1/lights/0/aim"},
               {levels_task, "the rig has no fixture \"more 1\""}};
  for (const auto& bad : cases) {
    const auto hung = hang_plan(bad.plan, rig_with_a_bulb(), "plan.json");
    ASSERT_FALSE(hung) << bad.says;
    EXPECT_NE(hung.error()[0].what.find(bad.says), std::string::npos) << hung.error()[0].text();
  }
}

TEST(Plan, CarriesPowerAndColour) {
  Plan plan = plan_for_two(0.5, 0.25);
  plan.tasks[0].lights[0].watts = 6;
  plan.tasks[0].watts = 9.5;
  plan.tasks[0].front = {{12, 11.5, 0.1}, {6, 6, 0.4}};
  PlannedPoint point;
  point.name = "desk";
  point.xy = Chromaticity(0.44, 0.4);
  point.goal_xy = Chromaticity(0.45, 0.41);
  plan.points = {point};
  const std::string text = to_json(plan);
  const auto back = plan_from_json(text, "plan.json");
  ASSERT_TRUE(back) << back.error()[0].text();
  EXPECT_EQ(back->tasks[0].lights[0].watts, 6);
  EXPECT_FALSE(back->tasks[0].lights[1].watts);
  EXPECT_EQ(back->tasks[0].watts, 9.5);
  ASSERT_EQ(back->tasks[0].front.size(), 2u);
  EXPECT_EQ(back->tasks[0].front[1].max_watts, 6);
  EXPECT_EQ(back->tasks[0].front[0].watts, 11.5);
  EXPECT_EQ(back->tasks[0].front[1].normalised_error, 0.4);
  EXPECT_EQ(back->points[0].xy, point.xy);
  EXPECT_EQ(back->points[0].goal_xy, point.goal_xy);
  // An older plan, from before colours existed, has none.
  const auto old = plan_from_json(to_json(plan_for_two(0.5, 0.25)), "plan.json");
  ASSERT_TRUE(old);
  EXPECT_FALSE(old->tasks[0].watts);
  EXPECT_TRUE(old->tasks[0].front.empty());
  const auto wrong = plan_from_json(
      R"({"luxrig_plan":1,"rig":"r","tasks":[],"points":[{"name":"p","xy":[0.3]},{"name":"q","goal_xy":"red"}]})",
      "plan.json");
  ASSERT_FALSE(wrong);
  ASSERT_EQ(wrong.error().size(), 2u);
  EXPECT_NE(wrong.error()[0].text().find("/points/0/xy"), std::string::npos) << wrong.error()[0].text();
}

// The person who hangs lamps is given the lamp's name, not that of an emitter.
TEST(Plan, NamesTheHousingOfUnhungEmitters) {
  Rig rig = two_fixture_rig();
  rig.luminaires.resize(2);
  rig.luminaires[0].name = "par";
  rig.luminaires[0].emitters = {1};
  rig.luminaires[1].name = "par/red";
  rig.luminaires[1].emitter_of = 0;
  Plan plan = plan_for_two(0.5, 0.25);
  PlannedLight placed = light("more 1/red", 0.5);
  placed.luminaire = "par/red";
  plan.tasks.push_back({.name = "more", .kind = "placement", .lights = {placed}});
  const auto levels = levels_for(plan, rig, "plan.json");
  ASSERT_FALSE(levels);
  EXPECT_NE(levels.error()[0].mend.find("hang a par at"), std::string::npos) << levels.error()[0].text();
  EXPECT_NE(levels.error()[0].mend.find("called \"more 1\""), std::string::npos) << levels.error()[0].text();
}

TEST(Plan, CarriesTheResultsForARelief) {
  Plan plan = plan_for_two(0.5, 0.25);
  plan.tasks[0].kind = "aim";
  PlannedRelief relief;
  relief.local_contrast_lx = 74.5;
  relief.coverage = 0.33;
  relief.relative_contrast = 0.21;
  relief.before_local_contrast_lx = 56;
  relief.object_lux = 1042;
  relief.key_to_fill = 1.25;
  relief.seen = 1.5;
  relief.before_seen = 0.75;
  relief.lit_share = 0.875;
  relief.clipped_share = 0.0625;
  plan.tasks[0].relief = relief;
  plan.tasks[0].numbers = {{1, std::nan(""), 40.0}, {2, std::nan(""), 61.5}};
  const auto back = plan_from_json(to_json(plan), "plan.json");
  ASSERT_TRUE(back) << back.error()[0].text();
  const PlannedTask& task = back->tasks[0];
  ASSERT_TRUE(task.relief);
  EXPECT_EQ(task.relief->local_contrast_lx, 74.5);
  EXPECT_EQ(task.relief->coverage, 0.33);
  EXPECT_EQ(task.relief->relative_contrast, 0.21);
  EXPECT_EQ(task.relief->before_local_contrast_lx, 56);
  EXPECT_FALSE(task.relief->before_coverage);
  EXPECT_EQ(task.relief->object_lux, 1042);
  EXPECT_EQ(task.relief->key_to_fill, 1.25);
  EXPECT_EQ(task.relief->seen, 1.5);
  EXPECT_EQ(task.relief->before_seen, 0.75);
  EXPECT_EQ(task.relief->lit_share, 0.875);
  EXPECT_EQ(task.relief->clipped_share, 0.0625);
  ASSERT_EQ(task.numbers.size(), 2u);
  EXPECT_EQ(task.numbers[1].local_contrast_lx, 61.5);
  EXPECT_TRUE(std::isnan(task.numbers[1].normalised_error));
  EXPECT_FALSE(plan_from_json(to_json(plan_for_two(0.5, 0.25)), "plan.json")->tasks[0].relief);
}

}  // namespace
}  // namespace luxrig
