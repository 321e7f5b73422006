/// Power-up by stages: power added per second, order, and lamps that need not wait.
#include "core/output/startup_stages.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Four lamps of 100, 200, 300 and 400 W on two stages, one fixture a bus.
Rig lamps() {
  Rig rig;
  rig.name = "small";
  rig.buses.resize(4);
  for (std::size_t i = 0; i < 4; ++i) {
    rig.luminaires.emplace_back();
    rig.luminaires.back().watts = 100.0 * static_cast<double>(i + 1);
    rig.fixtures.emplace_back();
    rig.fixtures.back().name = std::string(1, static_cast<char>('a' + i));
    rig.fixtures.back().luminaire = i;
    rig.fixtures.back().bus = i;
    rig.buses[i].name = "bus " + rig.fixtures.back().name;
  }
  rig.fixtures[0].stage = rig.fixtures[2].stage = 2;
  rig.control.fade_s = 1;
  rig.safe.scope = SafeScope::all;
  return rig;
}

struct StartingShow {
  Rig rig = lamps();
  std::unique_ptr<ShowController> show;
  double now_s = 0;
  std::vector<bool> lost = std::vector<bool>(4, false);

  void start() { show = std::make_unique<ShowController>(rig, LightModel{}); }
  [[nodiscard]] std::vector<double> levels(double at_s) const {
    std::vector<double> level(4);
    show->program().levels_at(at(at_s), level);
    return level;
  }
  [[nodiscard]] std::vector<double> levels() const { return levels(now_s); }
  [[nodiscard]] double watts(double at_s) const {
    const auto level = levels(at_s);
    double sum = 0;
    for (std::size_t f = 0; f < 4; ++f) sum += level[f] * *rig.luminaires[f].watts;
    return sum;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 50)); ++i) {
      now_s += 0.02;
      std::vector<Health> health;
      for (std::size_t b = 0; b < 4; ++b)
        health.push_back({rig.buses[b].name, lost[b] ? Life::faulted : Life::active, "", {}, {}});
      show->health(at(now_s), health);
      show->step(at(now_s));
    }
  }
  [[nodiscard]] Phase phase() const { return show->status(at(now_s)).phase; }
};

TEST(StartupStages, NothingIsStagedByDefault) {
  StartingShow small;
  small.start();
  small.show->apply(at(0), std::vector<double>(4, 1.0));
  EXPECT_TRUE(small.show->program().lamp_starts.empty());
  small.run(1);
  EXPECT_EQ(small.levels(), std::vector<double>(4, 1.0));
}

TEST(StartupStages, StagesFollowInNumericOrder) {
  StartingShow small;
  small.rig.startup.stage_s = 3;
  small.start();
  small.show->apply(at(0), std::vector<double>{0.5, 1, 1, 0.25});
  small.run(0.5);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0.5, 0, 0.25}));  // the second stage waits
  EXPECT_NE(small.show->status(at(0.5)).detail.find("by stages"), std::string::npos);
  small.run(2.4);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 1, 0, 0.25}));
  small.run(1.1);
  EXPECT_EQ(small.levels(), (std::vector<double>{0.5, 1, 1, 0.25}));
  // The next look comes in the usual way.
  small.show->apply(at(small.now_s), std::vector<double>(4, 0.2));
  small.run(1);
  EXPECT_EQ(small.levels(), std::vector<double>(4, 0.2));
}

TEST(StartupStages, NoSecondAddsMoreWattsThanAllowed) {
  for (const bool with_stages : {false, true}) {
    StartingShow small;
    small.rig.startup.max_watts_per_s = 200;
    if (with_stages) small.rig.startup.stage_s = 0.7;
    small.start();
    const std::vector<double> wanted = {0.9, 1, 0.3, 0.8};
    small.show->apply(at(0), wanted);
    std::vector<double> begun(4, -1);
    for (double t = 0; t < 8; t += 0.02) {
      small.run(0.02);
      for (const double span_s : {0.005, 0.5, 1.0})
        ASSERT_LE(small.watts(small.now_s + span_s) - small.watts(small.now_s), 200 * span_s + 1e-6) << t;
      for (std::size_t f = 0; f < 4; ++f)
        if (begun[f] < 0 && small.levels()[f] > 0) begun[f] = small.now_s;
    }
    EXPECT_EQ(small.levels(), wanted);
    EXPECT_LT(begun[1], begun[3]);  // b, d: stage 1; a, c: stage 2
    EXPECT_LT(begun[3], begun[0]);
    EXPECT_LT(begun[0], begun[2]);
    // 200 W and 400 W at 200 W/s: the second stage after 3 s.
    EXPECT_NEAR(begun[0], 3, 0.05);
  }
}

TEST(StartupStages, ADesksLevelsAreStagedToo) {
  StartingShow small;
  small.rig.startup.stage_s = 5;
  small.start();
  ASSERT_EQ(small.show->add_desk({DeskMode::merge, HandBack::at_once}, {"desk", {0, 1, 2, 3}}), 0u);
  small.show->apply(at(0), std::vector<double>(4, 0.1));
  DeskFrame frame{DeskPresence::present, {}, "desk"};
  for (std::size_t f = 0; f < 4; ++f) frame.commands.push_back({f, 1.0, std::nullopt});
  small.show->desk(at(0.01), 0, frame);
  small.run(2);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 1, 0, 1}));
  small.run(4.2);
  EXPECT_EQ(small.levels(), std::vector<double>(4, 1.0));
}

TEST(StartupStages, BlackoutAndTheSafeLookNeverWait) {
  StartingShow small;
  small.rig.startup.stage_s = 100;
  small.rig.safe.level = 0.3;
  small.rig.safe.hold_s = 1;
  small.rig.safe.fade_s = 1;
  small.start();
  small.show->apply(at(0), std::vector<double>(4, 0.8));
  small.run(2);
  ASSERT_EQ(small.levels(), (std::vector<double>{0, 0.8, 0, 0.8}));
  small.show->blackout(at(small.now_s), true);
  EXPECT_EQ(small.levels(), std::vector<double>(4, 0.0));
  small.show->blackout(at(small.now_s), false);
  small.run(1.5);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0.8, 0, 0.8}));
  small.lost[1] = true;  // a bus fails
  small.run(1.3);
  ASSERT_EQ(small.phase(), Phase::frozen);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0.8, 0, 0.8}));  // no jump
  small.run(2.1);
  ASSERT_EQ(small.phase(), Phase::safe);
  for (const double level : small.levels()) EXPECT_NEAR(level, 0.3, 1e-12);  // including those that had not begun
}

TEST(StartupStages, LostLampsRestartInStagesOnlyWhereALossMeansAPowerCut) {
  for (const bool after_loss : {false, true}) {
    StartingShow small;
    small.rig.startup.max_watts_per_s = 200;
    small.rig.startup.after_loss = after_loss;
    small.rig.safe.hold_s = 60;
    small.start();
    small.show->apply(at(0), std::vector<double>(4, 1.0));
    small.run(10);
    ASSERT_EQ(small.levels(), std::vector<double>(4, 1.0));
    small.lost[3] = small.lost[2] = true;
    small.run(1);
    EXPECT_EQ(small.levels()[0], 1);
    EXPECT_EQ(small.levels()[3], after_loss ? 0.0 : 1.0);
    small.lost[3] = small.lost[2] = false;
    for (int i = 0; i < 300; ++i) {
      small.run(0.02);
      ASSERT_EQ(small.levels()[0], 1);
      ASSERT_TRUE(after_loss || small.levels()[3] == 1);
      ASSERT_LE(small.watts(small.now_s + 0.5) - small.watts(small.now_s), 100 + 1e-6);
    }
    EXPECT_EQ(small.levels(), std::vector<double>(4, 1.0));
  }
}

/// A daemon died in the middle of it. Its guardian held the lit lamps until our controller took over.
TEST(StartupStages, LitLampsStayOnAndTheRestComesByStages) {
  for (const bool by_watts : {false, true}) {
    StartingShow small;
    small.rig.startup.stage_s = 3;
    if (by_watts) small.rig.startup.max_watts_per_s = 100;
    small.start();
    const std::vector<double> wanted = {0.5, 1, 1, 0.9}, before = {0, 1, 0, 0.4};  // stage 2: a, c
    LightInForce light{{before, std::vector<Joints>(4)}, std::vector<double>(4, 0.2), 60, 1};
    small.show->go_on_from(at(0), light);
    small.run(0.1);
    ASSERT_EQ(small.levels(), before);
    small.show->apply(at(small.now_s), wanted);
    const double applied_s = small.now_s;
    std::vector<double> last = small.levels(), begun(4, -1);
    EXPECT_EQ(last, before);
    for (int i = 0; i < 800; ++i) {
      small.run(0.02);
      const std::vector<double> level = small.levels();
      for (std::size_t f = 0; f < 4; ++f) {
        ASSERT_GE(level[f], last[f]) << f << " at " << small.now_s;
        if (before[f] == 0 && begun[f] < 0 && level[f] > 0) begun[f] = small.now_s - applied_s;
      }
      ASSERT_LE(small.watts(small.now_s + 0.5) - small.watts(small.now_s), by_watts ? 50 + 1e-6 : 1e9) << small.now_s;
      last = level;
    }
    EXPECT_EQ(last, wanted);
    // One stage time after the burning lamps went on. 0.6 · 400 W at 100 W/s are done by then; c waits for a's 100 W.
    EXPECT_NEAR(begun[0], 3, 0.05);
    EXPECT_NEAR(begun[2], by_watts ? 4 : 3, 0.05);
  }
}

TEST(StartupStages, AHeadParkedBeforeItsStageIsNeverLit) {
  for (const bool power_first : {false, true}) {
    StartingShow small;
    small.rig.fixtures[1].moves = true;
    small.rig.fixtures[1].range = {-1, 1, -1, 1};
    small.rig.fixtures[1].pan_speed_rad_s = small.rig.fixtures[1].tilt_speed_rad_s = 1;
    small.rig.fixtures[1].park = Joints{0.8, 0.8};
    small.rig.startup.stage_s = 2;
    small.start();
    // Like a restarted daemon: the plan, and the parked heads.
    small.show->apply(at(0), std::vector<double>(4, 1.0));
    if (power_first) small.run(1);
    ASSERT_TRUE(small.show->park(at(small.now_s), {}));
    for (int i = 0; i < 600; ++i) {
      small.run(0.02);
      ASSERT_EQ(small.levels()[1], 0) << small.now_s;
    }
    EXPECT_EQ(small.levels(), (std::vector<double>{1, 0, 1, 1}));
  }
}

TEST(StartupStages, AHeadIsDarkUntilItHasHomed) {
  Rig rig = lamps();
  rig.fixtures[1].moves = true;
  rig.fixtures[1].range = {-1, 1, -1, 1};
  rig.fixtures[1].pan_speed_rad_s = rig.fixtures[1].tilt_speed_rad_s = 1;
  rig.fixtures[1].reset_s = 20;
  ShowController show(rig, LightModel{});
  show.apply(at(0), std::vector<double>(4, 1.0));
  // 20 s of homing, then at most 1 rad, plus half a second.
  std::vector<double> level(4);
  show.program().levels_at(at(21.4), level);
  EXPECT_EQ(level[1], 0);
  show.program().levels_at(at(22.6), level);
  EXPECT_EQ(level[1], 1);
}

}  // namespace
}  // namespace luxrig
