#include "core/show/show_controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two fixtures, each over one point with a meter: 100 lx per level, and 10 lx from the other fixture.
struct SmallShow {
  Rig rig;
  LightModel model;
  Eigen::Vector2d gain{0.9, 0.95};  ///< the truth
  std::unique_ptr<ShowController> show;
  double now_s = 0;

  SmallShow() {
    rig.name = "small";
    rig.buses.resize(2);
    rig.buses[0].name = "lights";
    rig.buses[1].name = "meters";
    for (const char* name : {"left", "right"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
      rig.points.emplace_back();
      rig.points.back().name = std::string("below ") + name;
      rig.points.back().goal_lx = 40;
      rig.luxmeters.emplace_back();
      rig.luxmeters.back().name = std::string("meter ") + name;
      rig.luxmeters.back().point = rig.points.size() - 1;
      rig.luxmeters.back().bus = 1;
    }
    rig.points[0].max_lx = 50;
    rig.control.fade_s = 1;
    rig.control.settle_s = 0.2;
    rig.safe.hold_s = 2;
    rig.safe.scope = SafeScope::all;
    rig.safe.on_meter_loss = true;
    model.point_lux_per_level = Eigen::MatrixXd{{100, 10}, {10, 100}};
    model.meter_lux_per_level = model.point_lux_per_level;
  }

  ShowController& start() {
    show = std::make_unique<ShowController>(rig, model);
    return *show;
  }
  [[nodiscard]] Time now() const { return at(now_s); }
  [[nodiscard]] ShowStatus status() const { return show->status(now()); }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(2);
    show->program().levels_at(now(), level);
    return level;
  }
  /// Meters without lag or noise, ten times a second; the show at 20 Hz.
  void run(double seconds) {
    const int steps = static_cast<int>(std::lround(seconds * 20));
    for (int i = 0; i < steps; ++i) {
      now_s += 0.05;
      const std::vector<double> level = levels();
      const Eigen::Vector2d lux = model.point_lux_per_level * Eigen::Vector2d(gain[0] * level[0], gain[1] * level[1]);
      for (std::size_t m = 0; m < 2; ++m) show->reading(now(), {m, lux[static_cast<Eigen::Index>(m)], now()});
      show->step(now());
    }
  }
};

TEST(ShowController, IsDarkAndIdleUntilAPlanIsApplied) {
  SmallShow small;
  small.start();
  small.run(10);
  EXPECT_EQ(small.status().phase, Phase::idle);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0}));
  EXPECT_FALSE(small.status().converged);
  EXPECT_TRUE(small.status().alarms.empty());
}

TEST(ShowController, FollowsADriftThatGoesOnWithACorrectionEveryTenSeconds) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run(20);
  ASSERT_EQ(small.status().phase, Phase::holding);
  std::vector<double> corrected_s;
  for (Phase before = Phase::holding; small.now_s < 90;) {
    small.gain *= 1 - 2e-4;  // 0.4 % a second: 2 % of the light in five
    small.run(0.05);
    const Phase phase = small.status().phase;
    if (phase == Phase::correcting && before != phase) corrected_s.push_back(small.now_s);
    before = phase;
  }
  ASSERT_GE(corrected_s.size(), 6u);
  for (std::size_t k = 1; k < corrected_s.size(); ++k) {
    EXPECT_GE(corrected_s[k] - corrected_s[k - 1], 10 - 1e-9);
    EXPECT_LE(corrected_s[k] - corrected_s[k - 1], 11.1);  // the next sample
  }
}

TEST(ShowController, GoesFromFadeToHoldingAndMeetsTheGoals) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  std::vector<Phase> walked;
  for (int i = 0; i < 400; ++i) {
    small.run(0.05);
    if (walked.empty() || walked.back() != small.status().phase) walked.push_back(small.status().phase);
  }
  ASSERT_GE(walked.size(), 6u);
  EXPECT_EQ(walked[0], Phase::fading);
  EXPECT_EQ(walked[1], Phase::settling);
  EXPECT_EQ(walked[2], Phase::measuring);
  EXPECT_EQ(walked[3], Phase::correcting);
  EXPECT_EQ(walked.back(), Phase::holding);
  const ShowStatus status = small.status();
  EXPECT_TRUE(status.converged) << status.detail;
  for (const PointStatus& point : status.points) {
    EXPECT_NEAR(*point.measured_lx, 40, 0.02 * 40 + 1e-9);
    EXPECT_TRUE(point.met()) << point.reason;
    EXPECT_EQ(point.reason, "");
  }
  EXPECT_EQ(status.detail, "all 2 goals met");
}

// The truth may be off by all that the luxmeter is off by, however often it is read.
TEST(ShowController, APredictionIsNoBetterThanTheMeterThatTaughtIt) {
  for (const double tolerance : {0.0, 0.05}) {
    SmallShow small;
    for (Luxmeter& meter : small.rig.luxmeters) meter.tolerance = tolerance;
    small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
    small.run(20);
    for (const PointStatus& point : small.status().points) {
      EXPECT_LT(point.standard_error_lx, (0.01 + tolerance) * point.predicted_lx);
      EXPECT_GE(point.standard_error_lx, tolerance / std::sqrt(3.0) * point.predicted_lx);
    }
  }
}

TEST(ShowController, ReducesAPlanUntilAMeterConfirmsItsLimit) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.49, 0.1});  // 50 lx in the model, exactly its limit
  small.run(1.0);
  const ShowStatus status = small.status();
  EXPECT_LT(status.fixtures[0].target_level, 0.49 * (1 - small.rig.limits.open_loop_margin) + 1e-9);
  const double worst_lx =
      small.rig.control.gain_max * (100 * status.fixtures[0].target_level + 10 * status.fixtures[1].target_level);
  EXPECT_LE(worst_lx, 50);
}

// Whatever is applied, and whatever the corrections.
TEST(ShowController, KeepsAPowerLimitInItsOutput) {
  SmallShow small;
  small.rig.luminaires.resize(1);
  small.rig.luminaires[0].watts = 50;
  small.rig.limits.max_watts = 30;
  small.rig.points[0].max_lx.reset();
  small.start().apply(small.now(), std::vector<double>{0.9, 0.6});  // 75 W
  double max_watts = 0;
  for (int i = 0; i < 80; ++i) {
    small.run(0.1);
    const std::vector<double> level = small.levels();
    max_watts = std::max(max_watts, 50 * (level[0] + level[1]));
  }
  EXPECT_LE(max_watts, 30);
  EXPECT_GT(max_watts, 29.9) << "goals of 40 lx want 39 W and more";
}

TEST(ShowController, ClampsOutOfRangeAndNaNLevels) {
  SmallShow small;
  small.rig.fixtures[1].max_level = 0.2;
  small.rig.points[0].max_lx.reset();
  small.start().apply(small.now(), std::vector<double>{std::nan(""), 7});
  EXPECT_EQ(small.status().fixtures[0].target_level, 0);
  EXPECT_EQ(small.status().fixtures[1].target_level, 0.2);
}

TEST(ShowController, IgnoresTimeThatGoesBackwards) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.3, 0.3});
  small.run(10);
  const ShowStatus before = small.status();
  const std::uint64_t revision = small.show->program().revision;
  Health gone;
  gone.device = "lights";
  gone.life = Life::faulted;
  const Health report[] = {gone};
  for (const double past_s : {9.0, 0.0, -1000.0}) {
    small.show->health(at(past_s), report);
    small.show->reading(at(past_s), {0, 1e6, at(past_s)});
    small.show->step(at(past_s));
  }
  small.show->step(small.now());
  EXPECT_EQ(small.status().phase, before.phase);
  EXPECT_EQ(small.show->program().revision, revision);
  EXPECT_EQ(small.status().points[0].measured_lx, before.points[0].measured_lx);
}

TEST(ShowController, ObeysABlackoutEvenWithALateCallersClock) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.3, 0.3});
  small.run(5);
  small.show->blackout(at(1), true);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0}));
  small.show->blackout(at(1), false);
  small.run(20);
  EXPECT_TRUE(small.status().converged);
}

TEST(ShowController, ChangesTheOutputOnlyWithANewRevision) {
  SmallShow small;
  small.start();
  std::uint64_t revision = small.show->program().revision;
  small.show->apply(small.now(), std::vector<double>{0.3, 0.3});
  EXPECT_GT(small.show->program().revision, revision);
  revision = small.show->program().revision;
  small.show->blackout(small.now(), true);
  EXPECT_GT(small.show->program().revision, revision);
  revision = small.show->program().revision;
  small.show->blackout(small.now(), true);
  EXPECT_EQ(small.show->program().revision, revision);
}

TEST(ShowController, StaysSafeOnRequestUntilTheNextPlan) {
  SmallShow small;
  small.start().apply(small.now(), std::vector<double>{0.3, 0.3});
  small.run(10);
  small.show->go_safe(small.now());
  EXPECT_EQ(small.status().phase, Phase::safe_fading);
  small.run(60);
  EXPECT_EQ(small.status().phase, Phase::safe);
  EXPECT_EQ(small.levels(), (std::vector<double>{0.1, 0.1}));
  small.show->apply(small.now(), std::vector<double>{0.3, 0.3});
  small.run(10);
  EXPECT_EQ(small.status().phase, Phase::holding);
}

TEST(ShowController, KeepsTheSafeLookWithinTheLimits) {
  SmallShow small;
  small.rig.safe.level = 0.9;
  small.rig.fixtures[1].safe_level = 0.05;
  small.start().go_safe(small.now());
  small.run(10);
  EXPECT_EQ(small.status().phase, Phase::safe);
  const std::vector<double> level = small.levels();
  EXPECT_LE(small.rig.control.gain_max * (100 * level[0] + 10 * level[1]), 50);
  EXPECT_GT(level[0], 0.1) << "scaled down, not out";
}

TEST(ShowController, AcceptsAPlanDuringAFailureAndShowsItAfterRecovery) {
  SmallShow small;
  Health gone;
  gone.device = "lights";
  gone.life = Life::faulted;
  gone.detail = "connection refused";
  const Health bad[] = {gone};
  small.start();
  small.run(1);
  small.show->health(small.now(), bad);
  small.run(1);
  EXPECT_EQ(small.status().phase, Phase::idle);
  ASSERT_EQ(small.status().alarms.size(), 1u);
  EXPECT_NE(small.status().alarms[0].text.find("2 fixtures cannot be controlled"), std::string::npos);
  small.show->apply(small.now(), std::vector<double>{0.3, 0.3});
  small.run(1);
  EXPECT_EQ(small.status().phase, Phase::frozen);
  EXPECT_FALSE(small.status().plan_waits);
  small.show->apply(small.now(), std::vector<double>{0.2, 0.2});
  EXPECT_TRUE(small.status().plan_waits) << "while light is held";
  small.run(10);
  EXPECT_EQ(small.status().phase, Phase::safe);
  gone.life = Life::active;
  const Health good[] = {gone};
  small.show->health(small.now(), good);
  small.run(0.4);
  EXPECT_EQ(small.status().phase, Phase::safe) << "not before it has been well for half a second";
  small.run(15);
  EXPECT_TRUE(small.status().converged) << small.status().detail;
  EXPECT_FALSE(small.status().plan_waits);
}

TEST(ShowController, RunsARigWithoutLuxmetersOpenLoop) {
  SmallShow small;
  small.rig.luxmeters.clear();
  small.model.meter_lux_per_level.resize(0, 2);
  small.start().apply(small.now(), std::vector<double>{0.2, 0.3});
  for (int i = 0; i < 200; ++i) small.show->step(at(0.05 * i));
  small.now_s = 10;
  EXPECT_EQ(small.status().phase, Phase::holding);
  EXPECT_FALSE(small.status().converged);
  EXPECT_EQ(small.levels(), (std::vector<double>{0.2, 0.3}));
}

TEST(ShowController, NeverJumpsUpOrLeavesItsBoundsOnAnyInput) {
  const double odd[] = {std::nan(""), std::numeric_limits<double>::infinity(), -1, 0, 1e-300, 40, 45, 1e308};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SmallShow small;
    small.start();
    std::mt19937_64 random(seed);
    std::vector<double> before(2, 0.0);
    for (int i = 0; i < 2000; ++i) {
      small.now_s += 0.05;
      const double when_s = small.now_s + (random() % 10 == 0 ? static_cast<double>(random() % 100) - 50 : 0);
      small.show->reading(small.now(), {random() % 3, odd[random() % 8], at(when_s)});
      if (random() % 50 == 0) {
        Health health;
        const char* names[] = {"lights", "left", "meters", "meter left", "?", ""};
        health.device = names[random() % 6];
        health.life = static_cast<Life>(random() % 3);
        const Health report[] = {health};
        small.show->health(small.now(), report);
      }
      if (random() % 100 == 0) small.show->apply(small.now(), std::vector<double>{odd[random() % 8], 0.5});
      if (random() % 300 == 0) small.show->blackout(small.now(), random() % 2 == 0);
      if (random() % 500 == 0) small.show->go_safe(small.now());
      small.show->step(small.now());
      const std::vector<double> level = small.levels();
      for (std::size_t j = 0; j < 2; ++j) {
        ASSERT_TRUE(level[j] >= 0 && level[j] <= 1);
        ASSERT_LE(level[j] - before[j], 1.5 * 0.05 / 1 + 1e-9) << "the fastest fade takes a second";
      }
      const ShowStatus status = small.status();
      ASSERT_TRUE(std::isfinite(status.points[0].predicted_lx) && std::isfinite(status.points[0].standard_error_lx));
      before = level;
    }
  }
}

/// The right fixture is a head: 90°/s. Its light on the points depends on its aim.
struct TurningShow : SmallShow {
  LightModel turned;
  TurningShow() {
    rig.fixtures[1].moves = true;
    rig.fixtures[1].range = {-kPi, kPi, -1, 1};
    rig.fixtures[1].pan_speed_rad_s = rig.fixtures[1].tilt_speed_rad_s = kPi / 2;
    turned = model;
    turned.point_lux_per_level = turned.meter_lux_per_level = Eigen::MatrixXd{{100, 80}, {10, 20}};
  }
  [[nodiscard]] static Look look(double pan_rad, std::vector<double> levels) {
    Look look;
    look.levels = std::move(levels);
    look.joints.resize(2);
    look.joints[1] = {pan_rad, 0};
    look.goal_lx = {45, 15};
    return look;
  }
  void run_until(Phase phase) {
    for (int i = 0; i < 2000 && status().phase != phase; ++i) run(0.05);
    ASSERT_EQ(status().phase, phase);
  }
};

TEST(ShowController, LightsNothingUntilItsHeadsMustHaveTurned) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.3, 0.3});
  // From either end of 360° to the middle: two seconds, plus half a second until it moves.
  const double applied_s = small.now_s;
  while (small.now_s < applied_s + 2.4) {
    small.run(0.05);
    EXPECT_EQ(small.levels(), (std::vector<double>{0, 0})) << small.now_s;
  }
  EXPECT_NE(small.status().detail.find("heads turn"), std::string::npos) << small.status().detail;
  small.run(0.5);
  EXPECT_GT(small.levels()[1], 0);
  small.run_until(Phase::holding);
}

TEST(ShowController, WaitsForAZoomLikeForPanAndTilt) {
  TurningShow small;
  Fixture& head = small.rig.fixtures[1];
  head.range.beam_min_rad = 0.1;
  head.range.beam_max_rad = 0.7;
  head.joints.beam_rad = 0.3;
  head.zoom_speed_rad_s = 0.1;
  small.start().apply(small.now(), std::vector<double>{0.3, 0.3});
  // From the wide end, 0.4 rad away: four seconds, plus half a second until it moves. Its pan takes two.
  const double applied_s = small.now_s;
  while (small.now_s < applied_s + 4.4) {
    small.run(0.05);
    EXPECT_EQ(small.levels()[1], 0) << small.now_s;
  }
  small.run(0.5);
  EXPECT_GT(small.levels()[1], 0);
}

TEST(ShowController, TurnsAHeadInTheDarkAndKeepsTheOthersLit) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run_until(Phase::holding);
  const std::vector<double> before = small.levels();
  ASSERT_GT(before[1], 0.3);
  ASSERT_TRUE(small.status().converged);

  small.show->apply(small.now(), small.look(1.5, {0.2, 0.3}), small.turned);
  EXPECT_EQ(small.status().phase, Phase::moving);
  EXPECT_EQ(small.status().points[0].goal_lx, 40) << "until it is taken";
  bool turned = false;
  double turned_s = 0, left = before[0];
  for (int i = 0; i < 100; ++i) {
    small.run(0.05);
    // The level goes to where its limit holds without the meters' corrections, but never by a jump.
    EXPECT_NEAR(small.levels()[0], left, 0.02) << small.now_s;
    left = small.levels()[0];
    EXPECT_GT(left, 0.1);
    const Joints& joints = small.show->program().joints[1];
    if (joints.pan_rad != 0 && !turned) {
      turned = true;
      turned_s = small.now_s;
      EXPECT_EQ(small.levels()[1], 0);
      EXPECT_EQ(small.status().points[0].goal_lx, 45);
    }
    // 1.5 rad at 90°/s, plus half a second.
    if (turned && small.now_s < turned_s + 1.4) {
      EXPECT_EQ(small.levels()[1], 0) << small.now_s - turned_s;
    }
    if (small.status().phase == Phase::settling) break;
  }
  ASSERT_TRUE(turned);
  small.model = small.turned;  // the room's true light from now on
  small.run_until(Phase::holding);
  const ShowStatus status = small.status();
  EXPECT_EQ(status.fixtures[1].joints.pan_rad, 1.5);
  EXPECT_NEAR(*status.points[0].measured_lx, 45, 0.03 * 45) << status.detail;
}

TEST(ShowController, ABlackoutTurnsHeadsAtOnceAndTheyComeBackLit) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run_until(Phase::holding);
  small.show->apply(small.now(), small.look(1.5, {0.2, 0.3}), small.turned);
  small.run(0.1);
  small.show->blackout(small.now(), true);
  small.run(0.1);
  EXPECT_EQ(small.show->program().joints[1].pan_rad, 1.5) << "nothing is lit that could sweep";
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0}));
  small.show->blackout(small.now(), false);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0}));
  small.model = small.turned;
  small.run_until(Phase::holding);
  EXPECT_GT(small.levels()[1], 0.05);
}

TEST(ShowController, AcceptsAPlanOrTheSafeLookWhileAHeadGoesDark) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run_until(Phase::holding);
  small.show->apply(small.now(), small.look(1.5, {0.2, 0.3}), small.turned);
  small.run(0.3);
  small.show->apply(small.now(), std::vector<double>{0.3, 0.3});  // as they look
  small.run_until(Phase::holding);
  EXPECT_EQ(small.show->program().joints[1].pan_rad, 0);

  small.show->apply(small.now(), small.look(1.5, {0.2, 0.3}), small.turned);
  small.run(0.3);
  small.show->go_safe(small.now());
  small.run_until(Phase::safe);
  EXPECT_EQ(small.show->program().joints[1].pan_rad, 0) << "the safe look is not the time to turn";
}

TEST(ShowController, ARedirectedHeadStaysDarkUntilItMustHaveArrived) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run_until(Phase::holding);
  small.show->apply(small.now(), small.look(1.5, {0.2, 0.3}), small.turned);
  while (small.show->program().joints[1].pan_rad == 0) small.run(0.05);
  // It has not begun to turn there, and has 3 rad to go, at 90° a second.
  const double told_s = small.now_s;
  small.show->apply(small.now(), small.look(3, {0.2, 0.3}), small.turned);
  ASSERT_EQ(small.show->program().joints[1].pan_rad, 3);
  while (small.now_s < told_s + 3 / (kPi / 2) + 0.5 - 0.05) {
    small.run(0.05);
    ASSERT_EQ(small.levels()[1], 0) << small.now_s - told_s;
  }
  small.run(3);
  EXPECT_GT(small.levels()[1], 0);
}

// Goals alone: the meters' corrections stay, and no head goes dark.
TEST(ShowController, NewGoalsKeepTheMetersCorrections) {
  TurningShow small;
  small.start().apply(small.now(), std::vector<double>{0.36, 0.36});
  small.run_until(Phase::holding);
  const double gain = small.status().fixtures[0].gain;
  ASSERT_LT(gain, 0.97);
  Look look = small.look(0, small.levels());
  look.goal_lx = {30, 20};
  small.show->apply(small.now(), look, small.model);
  EXPECT_EQ(small.status().phase, Phase::fading);
  EXPECT_EQ(small.status().fixtures[0].gain, gain);
  small.run_until(Phase::holding);
  EXPECT_NEAR(*small.status().points[0].measured_lx, 30, 0.03 * 30);
}

}  // namespace
}  // namespace luxrig
