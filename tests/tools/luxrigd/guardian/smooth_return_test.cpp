#include "tools/luxrigd/guardian/smooth_return.h"

#include <gtest/gtest.h>

#include <random>

#include "tools/luxrigd/blackout_switch.h"

namespace luxrig {
namespace {

using namespace std::chrono_literals;
constexpr Duration kCycle = std::chrono::microseconds(22727);

OutputProgram fade(std::vector<double> from, std::vector<double> to, Duration how_long) {
  OutputProgram program;
  program.revision = 1;
  program.max_level.assign(from.size(), 1.0);
  program.joints.resize(from.size());
  program.worst_lux_per_level.resize(0, static_cast<Eigen::Index>(from.size()));
  program.max_lx.resize(0);
  program.from_level = std::move(from);
  program.to_level = std::move(to);
  program.duration = how_long;
  program.start = Time{} + 1s;
  return program;
}

TEST(SmoothReturn, ChangesNothingWithoutAStall) {
  const OutputProgram program = fade({0, 1}, {1, 0.2}, 500ms);
  SmoothReturn smooth(2, kCycle);
  std::vector<double> level(2), wanted(2);
  for (Time at = program.start; at < program.start + 1s; at += kCycle) {
    program.levels_at(at, wanted);
    level = wanted;
    smooth.apply(at, program, false, level);
    EXPECT_EQ(level, wanted);
  }
}

// It used to jump by 123 of 255 in one frame.
TEST(SmoothReturn, NeverJumpsAfterAStallInAFade) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const auto draw = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
    OutputProgram program = fade({draw(), draw(), draw()}, {draw(), draw(), draw()}, from_seconds(0.5 + 4 * draw()));
    const bool limited = trial % 2 == 0;
    if (limited) {
      program.worst_lux_per_level = Eigen::MatrixXd::Constant(1, 3, 100);
      program.max_lx = Eigen::VectorXd::Constant(1, 160);
    }
    SmoothReturn smooth(3, kCycle);
    std::vector<double> level(3), last;
    const Time stall = program.start + from_seconds(draw() * to_seconds(program.duration));
    Time at = program.start - 200ms;
    const double rate_per_s = std::max(0.25, 1.25 * 1.5 / to_seconds(program.duration));
    bool stalled = false;
    while (at < program.start + program.duration + 8s) {
      program.levels_at(at, level);
      smooth.apply(at, program, false, level);
      double lux = 0;
      for (std::size_t f = 0; f < 3; ++f) {
        if (stalled) {
          EXPECT_LE(std::abs(level[f] - last[f]), rate_per_s * to_seconds(kCycle) + 0.01) << trial;
        }
        lux += 100 * level[f];
      }
      if (limited) {
        EXPECT_LE(lux, 160 * (1 + 1e-9));
      }
      last = level;
      if (!stalled && at >= stall) {
        at += from_seconds(0.2 + 3 * draw());
        stalled = true;
      }
      at += kCycle;
    }
    std::vector<double> wanted(3);
    program.levels_at(at, wanted);
    for (std::size_t f = 0; f < 3; ++f) EXPECT_NEAR(last[f], wanted[f], 1e-9) << "it arrives";
  }
}

TEST(SmoothReturn, GoesDarkAtOnce) {
  const OutputProgram program = fade({1}, {1}, 0s);
  SmoothReturn smooth(1, kCycle);
  std::vector<double> level{1};
  smooth.apply(Time{} + 1s, program, false, level);
  level = {0};
  smooth.apply(Time{} + 3s, program, true, level);
  EXPECT_EQ(level[0], 0);
}

TEST(SmoothReturn, DoesNotContinueFromForgottenLevels) {
  const OutputProgram program = fade({1}, {1}, 0s);
  SmoothReturn smooth(1, kCycle);
  std::vector<double> level{0.1};
  smooth.apply(Time{} + 1s, program, false, level);
  smooth.forget();
  level = {0.9};
  smooth.apply(Time{} + 3s, program, false, level);
  EXPECT_EQ(level[0], 0.9);
}

TEST(BlackoutSwitch, IsDarkAtOnceAndLitOnlyByTheNewestCommand) {
  BlackoutSwitch blackout;
  EXPECT_FALSE(blackout.dark());
  const auto on = blackout.order(true);
  EXPECT_TRUE(blackout.dark());
  const auto off = blackout.order(false);
  EXPECT_TRUE(blackout.dark()) << "the program that goes out has it still";
  EXPECT_FALSE(blackout.wanted());
  blackout.lift(on);
  EXPECT_TRUE(blackout.dark()) << "not by an older order";
  const auto again = blackout.order(true);
  blackout.lift(off);
  EXPECT_TRUE(blackout.dark()) << "somebody has asked again";
  blackout.lift(again);
  EXPECT_TRUE(blackout.dark()) << "what is wanted is dark";
  blackout.lift(blackout.order(false));
  EXPECT_FALSE(blackout.dark());
}

}  // namespace
}  // namespace luxrig
