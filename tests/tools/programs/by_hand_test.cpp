// Changes to a running rig, over the wire: levels and goals by hand, plans with goals, a reloaded rig file.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

/// A copy of a rig that a test may edit.
class EditedRig {
 public:
  EditedRig() {
    std::filesystem::copy(source("tests/rigs/room"), folder_ / "room", std::filesystem::copy_options::recursive);
  }
  [[nodiscard]] std::string path() const { return (folder_ / "room").string(); }
  [[nodiscard]] std::string file() const { return path() + "/rig.toml"; }
  void replace(const std::string& from, const std::string& to) {
    std::string text = text_of(file());
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    std::ofstream(file()) << text.replace(at, from.size(), to);
  }

 private:
  Folder folder_;
};

Ran client(LiveRig& rig, std::vector<std::string> words) {
  words.insert(words.begin(), program("luxrig"));
  words.insert(words.end(), {"--port", std::to_string(rig.port())});
  return luxrig::testing::run(words);
}

double lux_of(const json& status, const std::string& point) {
  for (const json& p : status["points"])
    if (p["name"] == point) return p.value("measured_lux", p["predicted_lux"].get<double>());
  return -1;
}

TEST(ByHandOverTheWire, ALevelAndAGoalSurviveCorrectionsAndARestartUntilReleased) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  const double before = level_of(rig.status(), "bulb-1");
  const Ran held = client(rig, {"level", "spot-1", "5%"});
  ASSERT_EQ(held.code, 0) << held.output;
  EXPECT_NE(held.output.find("spot-1: level 0.05 by hand, until it is released"), std::string::npos) << held.output;
  ASSERT_EQ(client(rig, {"goal", "plinth-*", "30", "--for", "10min"}).code, 0);
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.last();
  std::this_thread::sleep_for(11s);  // longer than the wait between two drift corrections
  json status = rig.status();
  EXPECT_NEAR(level_of(rig.status(), "spot-1"), 0.05, 1e-6);
  EXPECT_NEAR(lux_of(status, "plinth-top"), 30, 1.5) << status;
  ASSERT_EQ(status["overrides"].size(), 2u) << status["overrides"];
  EXPECT_EQ(status["overrides"][0]["name"], "spot-1");
  EXPECT_GT(status["overrides"][0]["age_s"].get<double>(), 10);
  EXPECT_EQ(status["overrides"][1]["kind"], "goal");
  EXPECT_LT(status["overrides"][1]["remaining_s"].get<double>(), 600);
  const Ran told = client(rig, {"status"});
  EXPECT_NE(told.output.find("by hand"), std::string::npos) << told.output;

  const Ran unknown = client(rig, {"level", "spt-1", "0.1"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"spot-1\"?"), std::string::npos) << unknown.output;
  EXPECT_EQ(client(rig, {"level", "spot-1", "1.5"}).code, 2);
  EXPECT_EQ(client(rig, {"level", "spot-1"}).code, 2);
  EXPECT_EQ(client(rig, {"level", "spot-1", "0.1", "--for", "soon"}).code, 2);
  const Ran capped = client(rig, {"level", "bulb-1", "1"});
  EXPECT_EQ(capped.code, 0);
  EXPECT_NE(capped.output.find("0.9 (max_level)"), std::string::npos) << capped.output;
  EXPECT_EQ(client(rig, {"release", "bulb-1"}).code, 0);

  rig.daemon().signal(SIGKILL);
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  status = rig.status();
  EXPECT_NEAR(level_of(rig.status(), "spot-1"), 0.05, 1e-6) << rig.daemon().output();
  ASSERT_EQ(status["overrides"].size(), 2u) << status["overrides"];
  EXPECT_GT(status["overrides"][0]["age_s"].get<double>(), 11);
  EXPECT_NEAR(lux_of(status, "plinth-top"), 30, 1.5) << status;

  ASSERT_EQ(client(rig, {"release", "all"}).code, 0);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["overrides"].empty() && s["phase"] == "holding"; }, 60s));
  EXPECT_NEAR(lux_of(rig.last(), "plinth-top"), 150, 5) << rig.last();
  EXPECT_GT(before, 0);
}

TEST(ByHandOverTheWire, TheCorrectionKeepsAPlansLevelsByHandAndGoals) {
  EditedRig edited;
  LiveRig rig(edited.path());
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  const auto plan_file = rig.file("plan.json").string();
  const auto solve = [&] {
    return luxrig::testing::run({program("luxrig"), "solve", edited.path(), "-o", plan_file, "--max-error", "0.05"})
        .code;
  };
  ASSERT_EQ(solve(), 0);
  json plan = json::parse(text_of(plan_file));
  for (json& light : plan["tasks"][0]["lights"])
    if (light["name"] != "head-1") light["level"] = 0.05;
  std::ofstream(plan_file) << plan.dump(1);
  const Ran applied = client(rig, {"apply", plan_file});
  ASSERT_EQ(applied.code, 0) << applied.output;
  EXPECT_NE(applied.output.find("spot-1: level 0.05 by hand"), std::string::npos) << applied.output;
  ASSERT_TRUE(rig.wait_phase("holding", 60s));
  std::this_thread::sleep_for(11s);
  for (const char* fixture : {"spot-1", "bulb-1"}) EXPECT_NEAR(level_of(rig.status(), fixture), 0.05, 1e-6) << fixture;

  // The rig file gets another goal. Solved and applied, it holds, although the daemon has read the old file.
  edited.replace("goal_lx = 150", "goal_lx = 90");
  ASSERT_EQ(solve(), 0);
  ASSERT_EQ(client(rig, {"apply", plan_file}).code, 0);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["phase"] == "fading"; }, 10s));
  ASSERT_TRUE(rig.wait_phase("holding", 60s));
  std::this_thread::sleep_for(11s);
  const json status = rig.status();
  EXPECT_NEAR(lux_of(status, "plinth-top"), 90, 4) << status;
  EXPECT_TRUE(has_alarm(status, "rig.toml changed since the rig was read")) << status["alarms"];
}

TEST(ByHandOverTheWire, AReloadAppliesNewGoalsWithoutDarkeningAndRefusesAnotherBus) {
  EditedRig edited;
  LiveRig rig(edited.path());
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  edited.replace("goal_lx = 150", "goal_lx = 110");
  ASSERT_TRUE(rig.wait_status([](const json& s) { return has_alarm(s, "luxrig reload"); }, 20s)) << rig.last();
  const auto frames = [&] { return rig.status()["output"]["frames"].get<double>(); };
  const double frames_before = frames();
  const auto begun = std::chrono::steady_clock::now();
  const Ran reloaded = client(rig, {"reload"});
  ASSERT_EQ(reloaded.code, 0) << reloaded.output;
  EXPECT_NE(reloaded.output.find("goals differ"), std::string::npos) << reloaded.output;
  double least = 1e9;
  ASSERT_TRUE(rig.wait_status(
      [&](const json& s) {
        double sum = 0;
        for (const json& f : s["fixtures"]) sum += f["level"].get<double>();
        least = std::min(least, sum);
        return s["phase"] == "holding" && std::abs(lux_of(s, "plinth-top") - 110) < 5;
      },
      60s))
      << rig.last();
  const double passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  EXPECT_GE(frames() - frames_before, 0.7 * 44 * passed_s) << "the bus thread goes on as it was";
  EXPECT_GT(least, 0.5 * rig.level_sum());
  EXPECT_FALSE(has_alarm(rig.last(), "reload")) << rig.last()["alarms"];

  edited.replace("address = 10", "address = 20");
  edited.replace("goal_lx = 110", "goal_lx = 60");
  const Ran refused = client(rig, {"reload"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.output.find("rig.toml:"), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("\"head-1\": its patch"), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("needs a restart"), std::string::npos) << refused.output;
  std::this_thread::sleep_for(3s);
  EXPECT_NEAR(lux_of(rig.status(), "plinth-top"), 110, 5) << "nothing of it was taken";
}

TEST(ByHandOverTheWire, ARigFileChangedWhileStoppedIsNoticedAtTheStart) {
  EditedRig edited;
  LiveRig rig(edited.path());
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  // No person chose the plan in force: the new goals are solved.
  rig.daemon().signal(SIGKILL);
  edited.replace("goal_lx = 150", "goal_lx = 100");
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  EXPECT_NE(rig.daemon().output().find("the rig file has changed since (goals differ)"), std::string::npos)
      << rig.daemon().output();
  EXPECT_NEAR(lux_of(rig.last(), "plinth-top"), 100, 4) << rig.last();
  // A person chose this one: it stays, with an alarm until another is applied.
  const auto plan_file = rig.file("plan.json").string();
  const auto solve = [&] {
    return luxrig::testing::run({program("luxrig"), "solve", edited.path(), "-o", plan_file, "--max-error", "0.05"})
        .code;
  };
  ASSERT_EQ(solve(), 0);
  ASSERT_EQ(client(rig, {"apply", plan_file}).code, 0);
  rig.daemon().signal(SIGKILL);
  edited.replace("goal_lx = 100", "goal_lx = 130");
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  EXPECT_NEAR(lux_of(rig.last(), "plinth-top"), 100, 4) << rig.last();
  EXPECT_TRUE(has_alarm(rig.last(), "made for another version of this rig (goals differ)")) << rig.last()["alarms"];
  ASSERT_EQ(solve(), 0);
  ASSERT_EQ(client(rig, {"apply", plan_file}).code, 0);
  ASSERT_TRUE(rig.wait_status(
      [](const json& s) { return s["phase"] == "holding" && std::abs(lux_of(s, "plinth-top") - 130) < 5; }, 60s))
      << rig.last();
  EXPECT_FALSE(has_alarm(rig.last(), "another version")) << rig.last()["alarms"];
}

}  // namespace
}  // namespace luxrig::testing
