// `luxrig run` as a user starts it: on a simulated rig, over the real protocols, in real time.
#include <atomic>
#include <cmath>
#include <fstream>
#include <set>
#include <thread>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

TEST(Run, OnceReachesTheGoalsWritesTheTableAndEndsCleanly) {
  const Folder folder;
  const auto table = folder / "table.json";
  const Ran ran = luxrig::testing::run(
      {program("luxrig"), "run", source("tests/rigs/room"), "--sim", "--once", "--port", "0", "--json", table.string()},
      90s);
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json out = json::parse(text_of(table), nullptr, false);
  ASSERT_TRUE(out.is_object()) << ran.output;
  EXPECT_EQ(out["goals"]["met"], 1) << "plinth-top has a luxmeter";
  EXPECT_EQ(out["goals"]["missed"], 0);
  EXPECT_EQ(out["goals"]["unknown"], 1) << "nobody measures the floor";
  EXPECT_FALSE(out["goals_met"].get<bool>());
  EXPECT_EQ(out["limit_violations_in_truth"], 0);
  bool metered = false;
  for (const json& point : out["points"]) {
    if (!point.contains("measured_lux")) continue;
    metered = true;
    if (point["why"] == "") {
      EXPECT_NEAR(point["error"].get<double>(), 0, 0.03) << point;
    }
  }
  EXPECT_TRUE(metered);
}

// In the reading room, light for the measured goals leaves an unmeasured goal a fifth short, at the edge of what is
// known. The noise of the readings decides whether it is called missed or unknown; neither may be wrong.
TEST(Run, ShippedRigsMeetMeasuredGoalsWithinLimitsAndCallNoMetGoalMissed) {
  for (const char* name : {"gallery", "studio", "reading-room"}) {
    const Folder folder;
    const auto table = folder / "table.json";
    const Ran ran = luxrig::testing::run({program("luxrig"), "run", source(std::string("rigs/") + name), "--sim",
                                          "--once", "--sim-seed", "11", "--port", "0", "--json", table.string()},
                                         120s);
    const json out = json::parse(text_of(table), nullptr, false);
    ASSERT_TRUE(out.is_object()) << ran.output;
    EXPECT_EQ(ran.code, out["goals"]["missed"] > 0 ? 1 : 0) << ran.output;
    if (std::string(name) != "reading-room") {
      EXPECT_EQ(out["goals"]["missed"], 0) << ran.output;
    }
    EXPECT_EQ(out["limit_violations_in_truth"], 0) << name;
    for (const json& point : out["points"]) {
      if (point.value("verdict", "") == "missed") {
        const double off = std::abs(point["truth_lux"].get<double>() / point["goal_lux"].get<double>() - 1);
        EXPECT_GT(off, out["goals"]["tolerance"].get<double>()) << point;
      }
      if (!point.contains("measured_lux")) continue;
      EXPECT_NE(point.value("verdict", ""), "missed") << point;
      // A metered point without a goal has only a limit.
      EXPECT_TRUE(!point.contains("error") || std::abs(point["error"].get<double>()) <= 0.03 || point["why"] != "")
          << point;
      if (point.contains("max_lux")) {
        EXPECT_LE(point["truth_max_lux"].get<double>(), point["max_lux"].get<double>());
      }
    }
  }
}

TEST(Run, LampsOnRelaysAreOnOrOffAndADimmableOneCompensates) {
  const Folder folder;
  const auto table = folder / "table.json", plan = folder / "plan.json";
  const Ran solved =
      luxrig::testing::run({program("luxrig"), "solve", source("tests/rigs/relays"), "-o", plan.string()}, 60s);
  ASSERT_EQ(solved.code, 0) << solved.output;
  const json lights = json::parse(text_of(plan), nullptr, false)["tasks"][0]["lights"];
  EXPECT_EQ(lights[0]["level"], 1) << solved.output;
  EXPECT_EQ(lights[1]["level"], 0) << "the drawing would get too much";
  EXPECT_NEAR(lights[2]["level"].get<double>(), 0.53, 0.05);
  const Ran ran = luxrig::testing::run({program("luxrig"), "run", source("tests/rigs/relays"), "--sim", "--once",
                                        "--port", "0", "--json", table.string()},
                                       90s);
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json out = json::parse(text_of(table), nullptr, false);
  EXPECT_EQ(out["limit_violations_in_truth"], 0);
  EXPECT_NEAR(out["points"][0]["error"].get<double>(), 0, 0.03) << out["points"][0];
  EXPECT_GT(out["points"][0]["measured_lux"].get<double>(), 55) << "one lamp that dims gives 20 lx of that";
}

TEST(Run, PageShowsTheRunningRig) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  std::string url = luxrig::testing::run({program("luxrig"), "page", "--port", std::to_string(rig.port())}).output;
  url = url.substr(0, url.find('\n'));
  EXPECT_NE(url.find("/?open="), std::string::npos) << url;
  std::filesystem::create_directories(program("../screenshots"));
  const Ran page = luxrig::testing::run({"/usr/bin/env", "node", source("tests/web/page_test.mjs"), "--url", url,
                                         "--screenshot", program("../screenshots/daemon.png")},
                                        90s);
  EXPECT_EQ(page.code, 0) << page.output;
  EXPECT_GT(std::filesystem::file_size(program("../screenshots/daemon.png")), 10'000u);
}

TEST(Run, AKilledSimulatorHoldsTheLightThenGoesSafeThenResumes) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const double lit = rig.level_sum();
  ASSERT_GT(lit, 0.1);
  rig.kill_sim();
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["phase"] == "frozen" && !s["alarms"].empty(); }, 2s))
      << rig.last().dump(1);
  EXPECT_TRUE(rig.has_severe_alarm());
  EXPECT_NEAR(rig.level_sum(), lit, 1e-6) << "the light must be held, not changed";
  ASSERT_TRUE(rig.wait_phase("safe", 10s)) << rig.last().dump(1);
  rig.start_sim();
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.last().dump(1);
  EXPECT_TRUE(rig.last()["alarms"].empty()) << rig.last()["alarms"];
  EXPECT_NEAR(rig.level_sum(), lit, 0.1 * lit);
}

TEST(Run, CutAndGarbledMetersAreNamedWithinTwoSecondsAndClearedAfterwards) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  for (const char* fault : {"silent", "garbled"}) {
    const double before = rig.level_sum();
    rig.fault("meter-1", fault, true);
    ASSERT_TRUE(rig.wait_status([&](const json& s) { return !s["alarms"].empty(); }, 2s))
        << fault << rig.last().dump(1);
    EXPECT_LE(rig.level_sum(), before + 1e-6) << fault;
    rig.fault("meter-1", fault, false);
    ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["phase"] == "holding" && s["alarms"].empty(); }, 30s))
        << fault << rig.last().dump(1);
  }
}

// The second restart used to light the rig by itself: resuming the plan saved a state without blackout.
TEST(Run, ABlackoutSurvivesRestartsAndADamagedState) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "--port", std::to_string(rig.port())}).code, 0);
  for (int restart = 0; restart < 3; ++restart) {
    rig.daemon().signal(SIGKILL);
    if (restart == 2) {  // a disk that fails
      const std::string state = text_of(rig.file("state/state.json"));
      std::ofstream(rig.file("state/state.json")) << state.substr(0, state.size() / 2);
    }
    rig.start_daemon();
    ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == true; }, 30s)) << rig.daemon().output();
    std::this_thread::sleep_for(1s);
    ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == true; }, 5s)) << rig.last().dump(1);
    EXPECT_EQ(rig.level_sum(), 0) << restart;
  }
  EXPECT_NE(rig.daemon().output().find("state is damaged"), std::string::npos) << rig.daemon().output();
}

// A daemon that was killed while it restored the parts one by one used to save a state without a plan.
TEST(Run, TheDiskKeepsTheStateAtEveryInstantOfAStart) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const std::string port = std::to_string(rig.port());
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "level", "spot-1", "0.05", "--port", port}).code, 0);
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "--port", port}).code, 0);
  rig.daemon().signal(SIGKILL);
  const std::string saved = text_of(rig.file("state/state.json"));
  std::atomic<bool> watching{true};
  std::set<std::string> others;
  int looks = 0;
  std::thread watch([&] {
    for (; watching; ++looks)
      if (std::string text = text_of(rig.file("state/state.json")); text != saved) others.insert(std::move(text));
  });
  rig.start_daemon();
  EXPECT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == true; }, 30s)) << rig.daemon().output();
  std::this_thread::sleep_for(1s);
  watching = false;
  watch.join();
  EXPECT_GT(looks, 1000);
  const json before = json::parse(saved);
  for (const std::string& text : others) {
    const json now = json::parse(text, nullptr, false);
    ASSERT_FALSE(now.is_discarded()) << text;
    for (const char* key : {"blackout", "plan", "plan_of_rig", "by_hand"}) EXPECT_EQ(now[key], before[key]) << key;
  }
}

// It used to fail to start, after it had sent the guardian away.
TEST(Run, AnUnsavableStateIsReportedAndTheRigIsLit) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const std::string saved = text_of(rig.file("state/state.json"));
  rig.daemon().signal(SIGKILL);
  const auto in_the_way = rig.file("state/state.json.new");
  std::filesystem::create_directory(in_the_way);
  rig.start_daemon();
  const auto forgets = [](const json& s) {
    for (const json& alarm : s["alarms"])
      if (alarm["text"].get<std::string>().find("would be forgotten") != std::string::npos) return true;
    return false;
  };
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["phase"] == "holding" && forgets(s); }, 60s))
      << rig.daemon().output() << rig.last().dump(1);
  EXPECT_GT(rig.level_sum(), 0.1);
  // A person's command is not acknowledged then; a blackout is in force all the same.
  const std::string port = std::to_string(rig.port());
  EXPECT_NE(luxrig::testing::run({program("luxrig"), "blackout", "--port", port}).code, 0);
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == true; }, 5s));
  EXPECT_EQ(text_of(rig.file("state/state.json")), saved);
  std::filesystem::remove(in_the_way);
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "--port", port}).code, 0);
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return !forgets(s); }, 5s));
}

TEST(Run, BlackoutWinsAndIsLiftedByTheCommand) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const std::string port = std::to_string(rig.port());
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "--port", port}).code, 0);
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == true; }, 1s));
  EXPECT_EQ(rig.level_sum(), 0);
  EXPECT_TRUE(wait_for(
      [&] {
        double lux = 0;
        const json truth = rig.truth();
        for (const json& p : truth.at("points")) lux += p["lux"].get<double>();
        return lux < 0.5;
      },
      3s))
      << "the room itself must be dark";
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "--off", "--port", port}).code, 0);
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return s["blackout"] == false && s["phase"] == "holding"; }, 30s));
  const Ran status = luxrig::testing::run({program("luxrig"), "status", "--port", port});
  EXPECT_EQ(status.code, 0);
  EXPECT_NE(status.output.find("room: holding"), std::string::npos) << status.output;
}

TEST(Run, ADeadDaemonLeavesTheSafeLookToItsGuardianUntilTheNextOne) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  // A guardian that dies is replaced.
  const pid_t first = rig.guardian_pid();
  ::kill(first, SIGKILL);
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && rig.guardian_pid() != first; }, 5s));
  const auto room_lux = [&] {
    double lux = 0;
    const json truth = rig.truth();
    for (const json& p : truth.at("points")) lux += p["lux"].get<double>();
    return lux;
  };
  const double held_lux = room_lux();
  // [safe] level = 0.1; a lamp's own curve decides its light.
  const auto all_safe = [&] {
    const json truth = rig.truth();
    return std::all_of(truth.at("fixtures").begin(), truth.at("fixtures").end(),
                       [](const json& f) { return f["level"].get<double>() > 0.05 && f["level"].get<double>() < 0.2; });
  };
  EXPECT_FALSE(all_safe());
  rig.daemon().signal(SIGKILL);
  const auto killed = std::chrono::steady_clock::now();
  // hold_s = 2, fade_s = 1
  while (std::chrono::steady_clock::now() - killed < 1700ms) {
    EXPECT_NEAR(room_lux(), held_lux, 0.01 * held_lux);
    std::this_thread::sleep_for(50ms);
  }
  ASSERT_TRUE(wait_for(all_safe, 4s)) << rig.truth();
  // sACN receivers drop a source after 2.5 s: the guardian must keep sending.
  std::this_thread::sleep_for(3500ms);
  EXPECT_TRUE(all_safe()) << rig.truth();
  const pid_t guardian = rig.guardian_pid();
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  EXPECT_FALSE(runs(guardian)) << "the dead daemon's guardian must have left";
  EXPECT_NEAR(room_lux(), held_lux, 0.05 * held_lux);
  // An orderly end leaves no guardian.
  const pid_t last = rig.guardian_pid();
  EXPECT_GT(last, 1);
  rig.daemon().signal(SIGTERM);
  EXPECT_TRUE(wait_for([&] { return !runs(last) && rig.guardian_pid() == 0; }, 10s));
}

TEST(Run, ARestartedDaemonFadesFromItsGuardiansLevels) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const auto levels = [&] {
    std::vector<double> level;
    const json truth = rig.truth();
    for (const json& f : truth.at("fixtures")) level.push_back(f["level"].get<double>());
    return level;
  };
  const std::vector<double> planned = levels();
  for (const bool in_safe_look : {false, true}) {
    rig.daemon().signal(SIGKILL);
    // hold_s = 2, fade_s = 1: wait within the hold, or until the safe look of 0.1 is reached.
    std::this_thread::sleep_for(in_safe_look ? 4500ms : 300ms);
    const std::vector<double> before = levels();
    rig.start_daemon();
    std::vector<double> least = before, last = before;
    double largest_step = 0;
    auto looked = std::chrono::steady_clock::now();
    const auto watch = [&] {
      const std::vector<double> level = levels();
      const auto at = std::chrono::steady_clock::now();
      const double seconds = std::chrono::duration<double>(at - looked).count();
      looked = at;
      for (std::size_t f = 0; f < level.size(); ++f) {
        least[f] = std::min(least[f], level[f]);
        // A machine that stalls for a while sees much of a fade at once.
        if (seconds < 0.1) largest_step = std::max(largest_step, std::abs(level[f] - last[f]));
      }
      last = level;
    };
    ASSERT_TRUE(wait_for(
        [&] {
          watch();
          const json s = rig.status();
          return s.is_object() && s.value("phase", "") == "holding";
        },
        60s))
        << rig.daemon().output();
    // A daemon that starts after the hold finds the safe look; it never finds the dark.
    for (std::size_t f = 0; f < before.size(); ++f)
      EXPECT_GT(least[f], 0.8 * std::min({before[f], planned[f], 0.1})) << "lamp " << f << ", " << in_safe_look;
    EXPECT_LT(largest_step, 0.15) << in_safe_look;
    const std::vector<double> after = levels();
    for (std::size_t f = 0; f < after.size(); ++f) EXPECT_NEAR(after[f], planned[f], 0.05) << f;
  }
}

TEST(Run, IdentifyBlinksALampInTheRoomAndMonitorShowsTheOutput) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const std::string port = std::to_string(rig.port());
  const json fixture = rig.last()["fixtures"][0];
  const std::string name = fixture["name"];
  const auto room_lux = [&] {
    double lux = 0;
    const json truth = rig.truth();
    for (const json& p : truth.at("points")) lux += p["lux"].get<double>();
    return lux;
  };
  const double before_lux = room_lux();
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "identify", name, "--seconds", "4", "--port", port}).code, 0);
  double min_lux = before_lux, max_lux = before_lux;
  ASSERT_TRUE(wait_for(
      [&] {
        const double lux = room_lux();
        min_lux = std::min(min_lux, lux), max_lux = std::max(max_lux, lux);
        return max_lux - min_lux > 0.1 * before_lux;
      },
      4s))
      << before_lux;
  const Ran monitor = luxrig::testing::run({program("luxrig"), "monitor", "--once", "--port", port});
  EXPECT_EQ(monitor.code, 0);
  EXPECT_NE(monitor.output.find(name + " shows which one it is"), std::string::npos) << monitor.output;
  EXPECT_NE(monitor.output.find("universe 1"), std::string::npos) << monitor.output;
  // 4 s of blinking, half a second back, then the fade that releases the limits of a desk's light.
  EXPECT_TRUE(wait_for([&] { return std::abs(room_lux() - before_lux) < 0.03 * before_lux; }, 15s))
      << before_lux << " lx before, " << room_lux() << " lx now, " << rig.status().dump();
  const Ran unknown = luxrig::testing::run({program("luxrig"), "identify", name + "x", "--port", port});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"" + name + "\"?"), std::string::npos) << unknown.output;
}

TEST(Run, AppliedPlanIsAcknowledgedOnDiskAndResumed) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const auto plan = rig.file("plan.json").string();
  ASSERT_EQ(
      luxrig::testing::run({program("luxrig"), "solve", source("tests/rigs/room"), "-o", plan, "--max-error", "0.05"})
          .code,
      0);
  const Ran applied = luxrig::testing::run({program("luxrig"), "apply", plan, "--port", std::to_string(rig.port())});
  ASSERT_EQ(applied.code, 0) << applied.output;
  // A power cut right after the acknowledgement.
  rig.daemon().signal(SIGKILL);
  const json state = json::parse(text_of(rig.file("state") / "state.json"), nullptr, false);
  ASSERT_TRUE(state.is_object());
  EXPECT_EQ(json::parse(state["plan"].get<std::string>()), json::parse(text_of(plan)));
}

TEST(Run, EndsOnCtrlCThroughTheSafeLook) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  rig.daemon().signal(SIGINT);
  EXPECT_EQ(rig.daemon().wait(15s), 0) << rig.daemon().output();
  EXPECT_NE(rig.daemon().output().find("safe"), std::string::npos);
}

}  // namespace
}  // namespace luxrig::testing
