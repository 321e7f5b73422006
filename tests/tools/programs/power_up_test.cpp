// Power-up by stages, with the real programs: when each lamp begins, in the simulator's truth, also if the daemon dies
// in between.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/tools/programs/live_desk.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

constexpr double kStage_s = 2;
/// A lower level is a lamp's last or first 8-bit step: it counts as dark.
constexpr double kLit = 0.004;

struct LampsAt {
  double at_s = 0;  ///< simulator time
  std::map<std::string, double> level;
};

struct PowerUp {
  /// Replaces a line of the rig file, and passes options to the daemon.
  explicit PowerUp(const std::string& line = "stage_s = 2", const std::string& instead = "stage_s = 2",
                   std::vector<std::string> options = {})
      : rig(rig_file(folder, line, instead), std::move(options)) {}
  static std::string rig_file(const Folder& folder, const std::string& line, const std::string& instead) {
    const auto file = folder / "rig.toml";
    std::ofstream(file) << with_line(text_of(source("tests/rigs/power-up/rig.toml")), line, instead);
    return file.string();
  }

  LampsAt look() {
    LampsAt lamps;
    const json truth = rig.truth();
    lamps.at_s = truth.value("time_s", 0.0);
    for (const json& f : truth.value("fixtures", json::array())) lamps.level[f["name"]] = f["level"].get<double>();
    return lamps;
  }
  /// Samples until `done` or the bound; records when each lamp was first lit.
  bool watch(const std::function<bool(const LampsAt&)>& done, std::chrono::seconds bound) {
    const auto end = std::chrono::steady_clock::now() + bound;
    while (std::chrono::steady_clock::now() < end) {
      seen.push_back(look());
      for (const auto& [name, level] : seen.back().level)
        if (level > kLit) first_lit_s.emplace(name, seen.back().at_s);
      if (done(seen.back())) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }
  bool watch_until_lit(const std::string& name, std::chrono::seconds bound = 30s) {
    return watch([&](const LampsAt& now) { return now.level.at(name) > kLit; }, bound);
  }
  [[nodiscard]] double after_one_s(const std::string& name) const {
    return first_lit_s.contains(name) ? first_lit_s.at(name) - first_lit_s.at("one") : -1;
  }

  Folder folder;
  LiveRig rig;
  std::vector<LampsAt> seen;
  std::map<std::string, double> first_lit_s;
};

TEST(PowerUp, StagesFollowOneAnotherAtTheirTimes) {
  PowerUp bench;
  const double begun_s = bench.look().at_s;
  ASSERT_TRUE(bench.watch_until_lit("head")) << bench.rig.daemon().output();
  ASSERT_TRUE(bench.rig.wait_status(
      [](const json& s) { return s["detail"].get<std::string>().starts_with("lamps come on by stages"); }, 2s))
      << bench.rig.last();
  bench.watch([](const LampsAt&) { return false; }, 2s);
  // The head may have to home (2 s) and turn by 540 degrees (0.75 s), and obeys after half a second. The first look may
  // come half a second after the daemon's start.
  EXPECT_GT(bench.first_lit_s.at("one") - begun_s, 2.6);
  EXPECT_NEAR(bench.after_one_s("two"), kStage_s, 0.25);
  EXPECT_NEAR(bench.after_one_s("three"), 2 * kStage_s, 0.25);
  EXPECT_NEAR(bench.after_one_s("head"), 2 * kStage_s, 0.25);
  for (const auto& [name, level] : bench.seen.back().level) EXPECT_GT(level, 0.05) << name;
  EXPECT_TRUE(bench.rig.wait_phase("holding", 10s)) << bench.rig.last();
}

TEST(PowerUp, NoSecondAddsMoreWattsThanAllowed) {
  PowerUp bench("stage_s = 2", "max_watts_per_s = 100");
  ASSERT_TRUE(bench.rig.wait_phase("fading", 60s)) << bench.rig.daemon().output();
  bool holding = false;
  bench.watch([&](const LampsAt&) { return holding = bench.rig.status().value("phase", "") == "holding"; }, 30s);
  ASSERT_TRUE(holding);
  const auto watts = [](const LampsAt& lamps) {
    double sum = 0;
    for (const auto& [name, level] : lamps.level) sum += level * (name == "head" ? 200 : 100);
    return sum;
  };
  const std::vector<LampsAt>& seen = bench.seen;
  ASSERT_GT(watts(seen.back()), 60);
  for (std::size_t i = 0, j = 0; i < seen.size(); ++i) {
    while (j < seen.size() && seen[j].at_s < seen[i].at_s + 0.5) ++j;
    // A true lamp's curve is in places steeper than its nominal one.
    if (j == seen.size()) break;
    EXPECT_LT(watts(seen[j]) - watts(seen[i]), 1.25 * 100 * (seen[j].at_s - seen[i].at_s)) << seen[i].at_s;
  }
}

TEST(PowerUp, ANewDaemonContinuesThePowerUpOfADeadOne) {
  PowerUp bench;
  ASSERT_TRUE(bench.watch_until_lit("two")) << bench.rig.daemon().output();
  // In the middle of the second lamp's rise.
  bench.watch([](const LampsAt&) { return false; }, 0s);
  std::this_thread::sleep_for(250ms);
  ASSERT_TRUE(bench.rig.guardian_pid() > 1);
  bench.rig.daemon().signal(SIGKILL);
  std::this_thread::sleep_for(300ms);
  const LampsAt held = bench.look();
  ASSERT_GT(held.level.at("one"), 0.1);
  ASSERT_GT(held.level.at("two"), 0.02);
  ASSERT_EQ(held.level.at("three"), 0);
  ASSERT_EQ(held.level.at("head"), 0);
  bench.rig.start_daemon();
  bench.seen.clear();
  bench.first_lit_s.clear();
  ASSERT_TRUE(bench.watch_until_lit("head")) << bench.rig.daemon().output();
  bench.watch([](const LampsAt&) { return false; }, 3s);
  ASSERT_TRUE(bench.rig.wait_phase("holding", 10s)) << bench.rig.last();
  const LampsAt last = bench.look();
  double least_one = 1, least_two = 1, steepest = 0;
  for (std::size_t i = 0; i < bench.seen.size(); ++i) {
    const LampsAt& now = bench.seen[i];
    least_one = std::min(least_one, now.level.at("one"));
    least_two = std::min(least_two, now.level.at("two"));
    if (i == 0) continue;
    const LampsAt& before = bench.seen[i - 1];
    for (const auto& [name, level] : now.level)
      if (now.at_s - before.at_s < 0.05) steepest = std::max(steepest, std::abs(level - before.level.at(name)));
  }
  EXPECT_GT(least_one, 0.95 * std::min(held.level.at("one"), last.level.at("one")));
  EXPECT_GT(least_two, 0.95 * std::min(held.level.at("two"), last.level.at("two")));
  EXPECT_LT(steepest, 0.15) << "a rise over 0.8 s, seen every 50 ms";
  // Lamps that had not begun keep their delays, from the new daemon's first frame on.
  EXPECT_GT(bench.first_lit_s.at("three") - held.at_s, kStage_s);
  EXPECT_LT(std::abs(bench.first_lit_s.at("three") - bench.first_lit_s.at("head")), 0.5);
  for (const auto& [name, level] : last.level) EXPECT_GT(level, 0.05) << name;
}

TEST(PowerUp, AParkedHeadStaysDarkDuringTheNextDaemonsStages) {
  // As after a power cut: no guardian has held the light.
  PowerUp bench("reset_s = 2\nstage = 3", "reset_s = 2", {"--no-guardian"});
  ASSERT_TRUE(bench.rig.wait_phase("holding", 60s)) << bench.rig.daemon().output();
  const Ran parked = luxrig::testing::run({program("luxrig"), "park", "--port", std::to_string(bench.rig.port())});
  ASSERT_EQ(parked.code, 0) << parked.output;
  ASSERT_TRUE(bench.watch([](const LampsAt& now) { return now.level.at("head") == 0; }, 10s));
  bench.rig.daemon().signal(SIGKILL);
  bench.rig.start_daemon();
  // It starts dark. Every lamp must be: they have universes and ramps of their own.
  const auto dark = [](const LampsAt& now) {
    return std::ranges::all_of(now.level, [](const auto& lamp) { return lamp.second < kLit; });
  };
  ASSERT_TRUE(bench.watch(dark, 20s));
  bench.seen.clear();
  bench.first_lit_s.clear();
  ASSERT_TRUE(bench.watch_until_lit("three")) << bench.rig.daemon().output();
  bench.watch([](const LampsAt&) { return false; }, 3s);
  EXPECT_FALSE(bench.first_lit_s.contains("head")) << bench.first_lit_s.at("head");
  EXPECT_NEAR(bench.after_one_s("two"), kStage_s, 0.25);
  EXPECT_NEAR(bench.after_one_s("three"), 2 * kStage_s, 0.25);
}

}  // namespace
}  // namespace luxrig::testing
