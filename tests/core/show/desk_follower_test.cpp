#include "core/show/desk_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/output/output_program.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// One fixture that Luxrig drives to `own`, and a desk.
struct Shared {
  explicit Shared(DeskRules rules, double own_level = 0.2, double fade_s = 4) {
    DeskFollowerSettings settings;
    settings.rules = rules;
    settings.fixtures = {0};
    settings.dimmer_curve = {DimmerCurve::linear};
    settings.joints = {Joints{}};
    settings.fade = from_seconds(fade_s);
    settings.curve = FadeCurve::linear;
    follower.emplace(std::move(settings));
    program.from_level = program.to_level = {own_level};
    program.max_level = {1};
    program.joints = {Joints{}};
    program.worst_lux_per_level = program.any_lux_per_level = Eigen::MatrixXd(0, 1);
    program.desks = {follower->blend()};
  }
  void hear(double s, DeskPresence presence, double drive, std::optional<Joints> joints = {}) {
    DeskFrame frame;
    frame.presence = presence;
    frame.source = "desk";
    frame.commands = {{0, drive, joints}};
    const std::vector<double> level = {this->level(s)};
    const std::vector<Joints> present = {pose(s)};
    if (follower->hear(at(s), frame, {level, present, program.joints})) program.desks = {follower->blend()};
    step(s);
  }
  void step(double s) {
    if (follower->step(at(s))) program.desks = {follower->blend()};
  }
  void ask(double s) {
    const std::vector<double> level = {this->level(s)};
    const std::vector<Joints> present = {pose(s)};
    if (follower->hand_back(at(s), {level, present, program.joints})) program.desks = {follower->blend()};
  }
  double level(double s) const {
    std::vector<double> out(1);
    program.levels_at(at(s), out);
    return out[0];
  }
  Joints pose(double s) const {
    std::vector<Joints> out(1);
    program.joints_at(at(s), out);
    return out[0];
  }
  [[nodiscard]] bool silent() const { return program.desks[0].silent; }

  std::optional<DeskFollower> follower;
  OutputProgram program;
};

constexpr DeskPresence kUnknown = DeskPresence::unknown, kAbsent = DeskPresence::absent,
                       kPresent = DeskPresence::present;

TEST(DeskFollower, MergesByTheBrighterLevelAndTheLatestMovement) {
  Shared shared({DeskMode::merge, HandBack::at_once}, 0.4);
  EXPECT_FALSE(shared.silent());  // Luxrig has the light while it listens
  EXPECT_DOUBLE_EQ(shared.level(0), 0.4);
  shared.hear(1, kPresent, 0.7, Joints{0.1, 0.1});
  EXPECT_DOUBLE_EQ(shared.level(1), 0.7);
  EXPECT_EQ(shared.pose(1), Joints{});  // where the desk has looked all along is no movement
  shared.hear(2, kPresent, 0.1, Joints{0.2, 0.1});
  EXPECT_DOUBLE_EQ(shared.level(2), 0.4);
  EXPECT_EQ(shared.pose(2), (Joints{0.2, 0.1}));
  shared.program.joints = {Joints{1, 1}};
  shared.hear(3, kPresent, 0.1, Joints{0.2, 0.1});
  EXPECT_EQ(shared.pose(3), (Joints{1, 1}));
}

TEST(DeskFollower, FollowsThePhasesOfATakeoverInTime) {
  Shared shared({DeskMode::takeover, HandBack::fade}, 0.2, 4);
  EXPECT_TRUE(shared.silent());  // a desk may have the light: not known yet
  shared.hear(0, kUnknown, 0);
  EXPECT_TRUE(shared.silent());
  shared.hear(1, kPresent, 1.0);
  EXPECT_FALSE(shared.silent());
  EXPECT_EQ(shared.follower->phase(), DeskPhase::following);
  EXPECT_DOUBLE_EQ(shared.level(1), 1.0);
  shared.hear(2, kPresent, 0.6);
  EXPECT_DOUBLE_EQ(shared.level(2), 0.6);
  shared.hear(10, kAbsent, 0);  // lost: from its last values to Luxrig's own
  EXPECT_EQ(shared.follower->phase(), DeskPhase::own);
  const double wanted[] = {0.6, 0.5, 0.4, 0.3, 0.2, 0.2};
  for (int s = 0; s < 6; ++s) {
    EXPECT_NEAR(shared.level(10 + s), wanted[s], 1e-12) << s;
    shared.hear(10 + s, kAbsent, 0.99);
  }
  shared.hear(20, kPresent, 1.0);  // back, by fade
  const double back[] = {0.2, 0.4, 0.6, 0.8, 1.0, 1.0};
  for (int s = 0; s < 6; ++s) EXPECT_NEAR(shared.level(20 + s), back[s], 1e-12) << s;
}

TEST(DeskFollower, StandsBySilentlyAndTakesOverFromTheDesksLastValues) {
  Shared shared({DeskMode::standby, HandBack::fade}, 0.2, 4);
  shared.hear(0, kUnknown, 0);
  EXPECT_TRUE(shared.silent());
  shared.hear(2, kPresent, 0.8);
  EXPECT_TRUE(shared.silent());
  shared.hear(9.9, kPresent, 0.7);
  EXPECT_TRUE(shared.silent());
  shared.hear(12.5, kAbsent, 0.7);
  EXPECT_FALSE(shared.silent());
  EXPECT_NEAR(shared.level(12.5), 0.7, 1e-12);
  EXPECT_NEAR(shared.level(14.5), 0.45, 1e-12);
  EXPECT_NEAR(shared.level(16.5), 0.2, 1e-12);
  // Back: Luxrig goes to the desk's values first, and falls silent only when both are equal.
  shared.hear(20, kPresent, 0.6);
  EXPECT_FALSE(shared.silent());
  EXPECT_NEAR(shared.level(22), 0.4, 1e-12);
  shared.step(23.9);
  EXPECT_FALSE(shared.silent());
  EXPECT_NEAR(shared.level(24), 0.6, 1e-12);
  shared.step(24);
  EXPECT_TRUE(shared.silent());
}

TEST(DeskFollower, HandsBackAtOnceUnderThatRule) {
  Shared shared({DeskMode::standby, HandBack::at_once});
  shared.hear(0, kAbsent, 0);
  EXPECT_FALSE(shared.silent());
  EXPECT_DOUBLE_EQ(shared.level(0), 0);  // nothing sent so far: from dark, by fade
  EXPECT_DOUBLE_EQ(shared.level(2), 0.1);
  EXPECT_DOUBLE_EQ(shared.level(4), 0.2);
  shared.hear(5, kPresent, 0.9);
  EXPECT_TRUE(shared.silent());
  EXPECT_DOUBLE_EQ(shared.level(5), 0.9);
}

TEST(DeskFollower, HandsBackOnlyWhenAskedUnderThatRule) {
  Shared shared({DeskMode::takeover, HandBack::when_asked}, 0.2, 4);
  shared.ask(0);  // no desk there
  shared.hear(1, kPresent, 0.8);
  EXPECT_EQ(shared.follower->phase(), DeskPhase::following);  // the desk had the light before Luxrig started
  shared.hear(5, kAbsent, 0.8);
  shared.hear(20, kPresent, 1.0);
  EXPECT_EQ(shared.follower->phase(), DeskPhase::waiting);
  EXPECT_DOUBLE_EQ(shared.level(30), 0.2);
  shared.hear(31, kAbsent, 1.0);
  EXPECT_EQ(shared.follower->phase(), DeskPhase::own);
  shared.hear(32, kPresent, 1.0);
  shared.ask(40);
  EXPECT_NEAR(shared.level(42), 0.6, 1e-12);
  EXPECT_NEAR(shared.level(44), 1.0, 1e-12);
}

TEST(DeskFollower, NeverJumpsWhenADeskComesAndGoesDuringFades) {
  Shared shared({DeskMode::takeover, HandBack::fade}, 0.1, 4);
  shared.hear(0, kPresent, 1.0);
  double last = shared.level(0);
  bool there = true;
  for (int i = 1; i < 4000; ++i) {
    const double s = i * 0.02;
    if (i % 130 == 0) there = !there;  // comes and goes every 2.6 s, in the middle of each fade
    shared.hear(s, there ? kPresent : kAbsent, 1.0);
    const double now = shared.level(s);
    ASSERT_LE(std::abs(now - last), 0.9 * 0.02 / 4 + 1e-9) << s;
    last = now;
  }
}

TEST(DeskFollower, LeavesFixturesToLuxrigThatTheDeskDoesNotControl) {
  Shared shared({DeskMode::takeover, HandBack::at_once}, 0.3);
  DeskFrame frame{kPresent, {{7, 1.0, std::nullopt}}, "desk"};
  const std::vector<double> level = {0.3};
  (void)shared.follower->hear(at(0), frame, {level, shared.program.joints, shared.program.joints});
  shared.program.desks = {shared.follower->blend()};
  EXPECT_DOUBLE_EQ(shared.level(1), 0.3);
}

TEST(DeskFollower, ClampsInvalidDrivesAndTreatsNaNAsDark) {
  Shared shared({DeskMode::takeover, HandBack::at_once}, 0.3);
  shared.hear(0, kPresent, std::numeric_limits<double>::quiet_NaN());
  EXPECT_DOUBLE_EQ(shared.level(0), 0);
  shared.hear(1, kPresent, 7);
  EXPECT_DOUBLE_EQ(shared.level(1), 1);
  shared.hear(2, kPresent, -7);
  EXPECT_DOUBLE_EQ(shared.level(2), 0);
}

TEST(DeskFollower, ABlackoutOverridesTheDesk) {
  Shared shared({DeskMode::merge, HandBack::at_once});
  shared.hear(0, kPresent, 1.0);
  shared.program.blackout = true;
  EXPECT_DOUBLE_EQ(shared.level(1), 0);
}

TEST(OutputProgram, ReleasesLimitsForAnyLevelsByFadeWhenNoDeskIsInControl) {
  // A meter allows Luxrig 0.8 here; bounds alone would allow 0.5.
  Shared shared({DeskMode::takeover, HandBack::at_once}, 0.8, 2);
  shared.program.worst_lux_per_level = Eigen::MatrixXd::Constant(1, 1, 60);
  shared.program.any_lux_per_level = Eigen::MatrixXd::Constant(1, 1, 100);
  shared.program.max_lx = shared.program.any_max_lx = Eigen::VectorXd::Constant(1, 50);
  shared.program.limits_released = from_seconds(2);
  shared.hear(0, kPresent, 1.0);
  EXPECT_NEAR(shared.level(1), 0.5, 1e-9);  // whatever the desk asks for
  shared.hear(10, kAbsent, 1.0);
  double last = shared.level(10);
  for (int i = 0; i <= 500; ++i) {
    const double now = shared.level(10 + i * 0.01);
    EXPECT_LE(std::abs(now - last), 0.01) << i;
    last = now;
  }
  EXPECT_NEAR(shared.level(12), 0.5, 1e-9);
  EXPECT_NEAR(shared.level(14.01), 0.8, 1e-9);
}

TEST(OutputProgram, KeepsADeskFromLightingMovingHeads) {
  Shared shared({DeskMode::takeover, HandBack::at_once}, 0.0);
  shared.program.heads_arrive = at(5);
  shared.program.heads_guarded = {1};
  shared.hear(0, kPresent, 1.0);
  EXPECT_DOUBLE_EQ(shared.level(4.9), 0);
  EXPECT_DOUBLE_EQ(shared.level(5), 1);
}

}  // namespace
}  // namespace luxrig
