// The commands' contract: names, JSON keys, exit codes.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "core/geometry.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

TEST(Commands, EvaluateJsonHasTheContractsKeys) {
  const Ran ran =
      luxrig::testing::run({program("luxrig"), "evaluate", source("tests/rigs/room"), "--max-error", "0.05", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json out = json_in(ran);
  ASSERT_TRUE(out.is_object()) << ran.output;
  for (const char* key :
       {"model", "points", "wanted", "wanted_of", "rms_error", "relative_error", "rays", "seconds", "threads"})
    EXPECT_TRUE(out.contains(key)) << key;
  ASSERT_EQ(out["points"].size(), 4u) << "points, then luxmeters";
  for (const char* key : {"name", "position", "normal", "lux", "direct_lux", "standard_error_lux", "goal_lux"}) {
    EXPECT_TRUE(out["points"][0].contains(key)) << key;
  }
  EXPECT_LE(out["rms_error"].get<double>(), 0.05);
}

TEST(Commands, SolveJsonHasTheContractsKeysAndEvaluateAgreesWithIt) {
  const Folder folder;
  const auto plan = (folder / "plan.json").string();
  const Ran ran = luxrig::testing::run({program("luxrig"), "solve", source("tests/rigs/room"), "-o", plan, "--json"});
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json out = json::parse(text_of(plan), nullptr, false);
  ASSERT_TRUE(out.is_object());
  for (const char* key : {"tasks", "points", "limits", "seconds", "seed"}) EXPECT_TRUE(out.contains(key)) << key;
  for (const char* key : {"name", "kind", "normalised_error", "iterations", "seconds", "lights"}) {
    EXPECT_TRUE(out["tasks"][0].contains(key)) << key;
  }
  for (const char* key : {"name", "luminaire", "position", "level", "lumens"}) {
    EXPECT_TRUE(out["tasks"][0]["lights"][0].contains(key)) << key;
  }
  const Ran again =
      luxrig::testing::run({program("luxrig"), "evaluate", source("tests/rigs/room"), "--levels", plan, "--json"});
  ASSERT_EQ(again.code, 0) << again.output;
  const json lux = json_in(again);
  for (std::size_t i = 0; i < out["points"].size(); ++i) {
    EXPECT_NEAR(lux["points"][i]["lux"].get<double>(), out["points"][i]["lux"].get<double>(),
                0.04 * out["points"][i]["lux"].get<double>());
  }
}

TEST(Commands, CheckAcceptsEveryShippedRig) {
  std::vector<std::string> rigs = {source("rigs/studio/can.toml"), source("rigs/studio/portrait.toml"),
                                   source("rigs/planning/hung.toml")};
  for (const auto& entry : std::filesystem::directory_iterator(source("rigs")))
    if (std::filesystem::exists(entry.path() / "rig.toml")) rigs.push_back(entry.path().string());
  EXPECT_GE(rigs.size(), 6u);
  for (const std::string& rig : rigs) {
    const Ran ran = luxrig::testing::run({program("luxrig"), "check", rig});
    EXPECT_EQ(ran.code, 0) << rig << '\n' << ran.output;
    EXPECT_NE(ran.output.find("no problems found"), std::string::npos) << rig << '\n' << ran.output;
  }
}

TEST(Commands, ImportMakesAValidRigAndNeverOverwritesOne) {
  const Folder folder;
  const std::string rig = (folder / "imported").string();
  const std::string mvr = source("tests/data/fixtures/7-fixtures-sample.mvr");
  const Ran import = luxrig::testing::run({program("luxrig"), "import", mvr, "-o", rig});
  ASSERT_EQ(import.code, 0) << import.output;
  EXPECT_NE(import.output.find("7 fixtures of 1 kinds"), std::string::npos) << import.output;
  EXPECT_NE(import.output.find("not patched in the MVR file"), std::string::npos) << import.output;
  const Ran check = luxrig::testing::run({program("luxrig"), "check", rig});
  ASSERT_EQ(check.code, 0) << check.output;
  EXPECT_NE(check.output.find("Custom Robe ColorWash 2500 AT, mode DMX Mode, 16 slots"), std::string::npos)
      << check.output;
  EXPECT_NE(check.output.find("dimmer by \"Base_Dimmer\", 8 bit at slot 1"), std::string::npos) << check.output;
  const Ran again = luxrig::testing::run({program("luxrig"), "import", mvr, "-o", rig});
  EXPECT_EQ(again.code, 2) << again.output;
  EXPECT_NE(again.output.find("there is a rig already"), std::string::npos) << again.output;
}

TEST(Commands, DaylightIsReportedSeparatelyAndCountedEverywhere) {
  const Folder folder;
  const auto plan = (folder / "plan.json").string();
  const Ran solved = luxrig::testing::run(
      {program("luxrig"), "solve", source("rigs/reading-room"), "--max-error", "0.03", "-o", plan, "--json"});
  ASSERT_EQ(solved.code, 0) << solved.output;
  const json out = json::parse(text_of(plan), nullptr, false);
  const Ran lit = luxrig::testing::run(
      {program("luxrig"), "evaluate", source("rigs/reading-room"), "--max-error", "0.03", "--levels", plan, "--json"});
  ASSERT_EQ(lit.code, 0) << lit.output;
  const json points = json_in(lit)["points"];
  ASSERT_EQ(points.size(), 11u);
  double window_lx = 0, inner_lx = 0;
  for (std::size_t i = 0; i < out["points"].size(); ++i) {
    const json& at = points[i];
    const double lux = at["lux"].get<double>(), daylight_lux = at["daylight_lux"].get<double>();
    EXPECT_GT(daylight_lux, 50) << at;
    EXPECT_GT(lux, daylight_lux + 50) << at;
    EXPECT_NEAR(lux, out["points"][i]["lux"].get<double>(), 0.1 * lux) << at;
    if (at["name"] == "window-west") window_lx = daylight_lux;
    if (at["name"] == "inner-west") inner_lx = daylight_lux;
    EXPECT_NEAR(lux, at.value("goal_lux", lux), 0.2 * lux) << at;
  }
  EXPECT_GT(window_lx, 3 * inner_lx);
  double window_level = 1, inner_level = 0;
  for (const json& light : out["tasks"][0]["lights"]) {
    if (light["name"] == "panel window-west") window_level = light["level"].get<double>();
    if (light["name"] == "panel inner-west") inner_level = light["level"].get<double>();
  }
  EXPECT_LT(window_level, 0.2);
  EXPECT_GT(inner_level, 0.5);
  ASSERT_EQ(out["limits"].size(), 1u);
  EXPECT_TRUE(out["limits"][0]["met"].get<bool>()) << out["limits"][0];
}

TEST(Commands, SolveRefusesALimitThatDaylightAloneBreaks) {
  const Folder folder;
  std::filesystem::copy(source("rigs/reading-room"), folder / "room");
  std::string text = text_of(folder / "room/rig.toml");
  text.replace(text.find("max_lx = 350"), 12, "max_lx = 60 ");
  std::ofstream(folder / "room/rig.toml") << text;
  const Ran ran = luxrig::testing::run({program("luxrig"), "solve", (folder / "room").string(), "--max-error", "0.05"});
  EXPECT_NE(ran.code, 0);
  EXPECT_NE(ran.output.find("point \"print\" has"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("of daylight alone, its limit is 60 lx"), std::string::npos) << ran.output;
}

TEST(Commands, SolveMixesColoursWithinAPowerLimitAndThePlanRenders) {
  const Folder folder;
  const auto plan = (folder / "plan.json").string();
  const Ran ran = luxrig::testing::run({program("luxrig"), "solve", source("rigs/stage"), "-o", plan});
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json out = json::parse(text_of(plan), nullptr, false);
  ASSERT_TRUE(out.is_object()) << ran.output;
  const json& task = out["tasks"][0];
  ASSERT_EQ(task["lights"].size(), 13u) << "three pars of four emitters, and one front light";
  EXPECT_EQ(task["lights"][0]["name"], "par left/red");
  EXPECT_LE(task["watts"].get<double>(), 40);
  double watts = 0;
  for (const json& light : task["lights"]) watts += light["watts"].get<double>();
  EXPECT_NEAR(task["watts"].get<double>(), watts, 1e-9);
  ASSERT_EQ(out["points"].size(), 4u);
  for (const json& point : out["points"]) {
    const auto xy = point["xy"].get<std::vector<double>>(), goal = point["goal_xy"].get<std::vector<double>>();
    EXPECT_NEAR(xy[0], goal[0], 0.03) << point["name"];
    EXPECT_NEAR(xy[1], goal[1], 0.03) << point["name"];
  }
  const Ran picture = luxrig::testing::run({program("luxrig"), "render", source("rigs/stage"), plan, "-o",
                                            (folder / "stage.png").string(), "--width", "64"});
  EXPECT_EQ(picture.code, 0) << picture.output;
}

/// Solves tests/rigs/hang; returns the plan's JSON.
json places_found(const std::filesystem::path& plan, const std::vector<std::string>& further = {}) {
  std::vector<std::string> words = {program("luxrig"), "solve", source("tests/rigs/hang"), "-o", plan.string()};
  words.insert(words.end(), further.begin(), further.end());
  const Ran ran = luxrig::testing::run(words);
  EXPECT_EQ(ran.code, 0) << ran.output;
  return json::parse(text_of(plan), nullptr, false);
}

TEST(Commands, SolvePlacesLightsAndEvaluateAndRenderShowThem) {
  const Folder folder;
  const auto plan = folder / "plan.json";
  const json out = places_found(plan);
  ASSERT_TRUE(out.is_object());
  const json& task = out["tasks"][0];
  EXPECT_EQ(task["kind"], "placement");
  for (const char* key : {"name", "kind", "normalised_error", "iterations", "seconds", "lights"})
    EXPECT_TRUE(task.contains(key)) << key;
  EXPECT_LE(task["normalised_error"].get<double>(), 0.002);
  ASSERT_EQ(task["lights"].size(), 3u);
  // The lights from which the goals were made: tests/rigs/hang.
  const struct {
    Vec3 at;
    double level;
  } known[] = {{{-1.2, -0.8, 2.1}, 0.9}, {{1.1, 0.7, 1.9}, 0.6}, {{0.3, -0.4, 2.2}, 0.4}};
  for (const auto& lamp : known) {
    double nearest_m = 10, level = 0;
    for (const json& light : task["lights"]) {
      for (const char* key : {"name", "luminaire", "position", "level", "lumens"}) EXPECT_TRUE(light.contains(key));
      const auto p = light["position"].get<std::vector<double>>();
      const double off_m = (Vec3(p[0], p[1], p[2]) - lamp.at).norm();
      if (off_m < nearest_m) level = light["level"].get<double>();
      nearest_m = std::min(nearest_m, off_m);
    }
    EXPECT_LE(nearest_m, 0.03);
    EXPECT_NEAR(level, lamp.level, 0.02 * lamp.level);
  }
  const Ran lit = luxrig::testing::run(
      {program("luxrig"), "evaluate", source("tests/rigs/hang"), "--levels", plan.string(), "--json"});
  ASSERT_EQ(lit.code, 0) << lit.output;
  const json points = json_in(lit)["points"];
  ASSERT_EQ(points.size(), 20u);
  for (const json& point : points)
    EXPECT_NEAR(point["lux"].get<double>(), point["goal_lux"].get<double>(), 0.01 * point["goal_lux"].get<double>());
  const Ran picture =
      luxrig::testing::run({program("luxrig"), "render", source("tests/rigs/hang"), plan.string(), "-o",
                            (folder / "hang.png").string(), "--passes", "1", "--width", "32", "--height", "32"});
  EXPECT_EQ(picture.code, 0) << picture.output;
}

TEST(Commands, PlacementDoesNotDependOnTheThreads) {
  const Folder folder;
  const auto lights = [&](const char* threads) {
    return places_found(folder / "plan.json", {"--threads", threads})["tasks"][0]["lights"].dump();
  };
  EXPECT_EQ(lights("1"), lights("3"));
}

TEST(Commands, ARigWithUnhungLightsCannotRun) {
  const Ran ran = luxrig::testing::run({program("luxrig"), "run", source("tests/rigs/hang"), "--sim", "--once"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.output.find("nothing hangs in this rig yet"), std::string::npos) << ran.output;
}

TEST(Commands, AnInterruptEndsAPlacementSearchWithTheBestSoFar) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/hang"), folder / "hang");
  std::string text = text_of(folder / "hang/rig.toml");
  // Many goals that cannot be met: the search takes over a minute on the fastest machine.
  text.replace(text.find("lights = 3"), 10, "lights = 30");
  text.replace(text.find("error_wanted = 0.0005"), 21, "error_wanted = 0");
  text.replace(text.find("spacing_m = 0.25"), 16, "spacing_m = 0.1");
  std::ofstream(folder / "hang/rig.toml") << text;
  std::ofstream goals(folder / "hang/goals.csv");
  goals << "name,x_m,y_m,z_m,goal_lx\n";
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      goals << "p" << 20 * i + j << ',' << -1.8 + 0.18 * i << ',' << -1.3 + 0.13 * j << ",0.1,"
            << 5 + (7 * i + 13 * j) % 23 << '\n';
  goals.close();
  const auto plan = folder / "plan.json";
  Process solve({program("luxrig"), "solve", (folder / "hang").string(), "-o", plan.string()}, folder / "log");
  // The first progress line with an error comes from a search that has a result to keep.
  ASSERT_TRUE(wait_for([&] { return solve.output().find(" lights, error ") != std::string::npos; }, 60s))
      << solve.output();
  solve.signal(SIGINT);
  EXPECT_LE(solve.wait(30s), 1) << "1: the best so far misses a goal\n" << solve.output();
  EXPECT_NE(solve.output().find("stopped: this is the best so far"), std::string::npos) << solve.output();
  const json out = json::parse(text_of(plan), nullptr, false);
  ASSERT_TRUE(out.is_object());
  EXPECT_FALSE(out["tasks"][0]["lights"].empty());
  EXPECT_EQ(out["points"].size(), 400u);
}

TEST(Commands, AMissingSurfaceIsRefusedWithItsPlace) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/hang"), folder / "hang");
  std::string text = text_of(folder / "hang/rig.toml");
  text.replace(text.find("spacing_m = 0.25"), 16, "surfaces = [\"rome\"]");
  std::ofstream(folder / "hang/rig.toml") << text;
  for (const char* command : {"check", "solve"}) {
    const Ran ran = luxrig::testing::run({program("luxrig"), command, (folder / "hang").string()});
    EXPECT_EQ(ran.code, 2);
    EXPECT_TRUE(std::regex_search(ran.output, std::regex("rig.toml:[0-9]+:13: surfaces \"rome\" fits no material or "
                                                         "object of the scene: did you mean \"room\"")))
        << ran.output;
  }
}

TEST(Commands, EvaluateGivesTheSameResultForAnyNumberOfThreads) {
  const auto lux = [](const char* threads) {
    const Ran ran = luxrig::testing::run({program("luxrig"), "evaluate", source("tests/rigs/room"), "--max-error",
                                          "0.02", "--threads", threads, "--json"});
    json out = json_in(ran);
    return out.is_object() ? out["points"].dump() : ran.output;
  };
  EXPECT_EQ(lux("1"), lux("3"));
}

TEST(Commands, BadRigsAreRefusedWithTheirPlaceBeforeAnythingMoves) {
  int seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source("tests/rigs/bad"))) {
    if (entry.path().extension() != ".toml") continue;
    const Ran ran =
        luxrig::testing::run({program("luxrig"), "run", entry.path().string(), "--sim", "--once", "--port", "0"});
    EXPECT_EQ(ran.code, 2) << entry.path() << ran.output;
    // A place in the rig file, or in a file it names (a points file).
    EXPECT_TRUE(std::regex_search(ran.output, std::regex("/tests/rigs/bad/[^:]+:[0-9]+:[0-9]+: ")))
        << entry.path() << ran.output;
    EXPECT_EQ(ran.output.find("simulated rig started"), std::string::npos) << entry.path();
    EXPECT_LT(ran.processor_seconds, 1.0) << entry.path();
    ++seen;
  }
  EXPECT_GE(seen, 30);
}

TEST(Commands, ClientsReportTheRemedyWithoutADaemon) {
  const Ran ran = luxrig::testing::run({program("luxrig"), "status", "--port", "9"});
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.output.find("luxrig run"), std::string::npos) << ran.output;
}

TEST(Commands, WrongArgumentsAreBadInput) {
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "solve"}).code, 2);
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "no-such"}).code, 2);
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "solve", source("tests/rigs/room"), "--max-error", "7"}).code, 2);
}

}  // namespace
}  // namespace luxrig::testing
