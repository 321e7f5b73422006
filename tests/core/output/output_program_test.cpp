#include "core/output/dimming.h"
#include "core/output/output_program.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <random>

#include "tests/core/output/at.h"

// Counts allocations of this program, to show that the output path makes none. Not inlined: g++ would compare malloc in
// one with free in the other and warn of a mismatch.
static std::atomic<std::size_t> allocations{0};
[[gnu::noinline]] void* operator new(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new[](std::size_t size) { return operator new(size); }
// std::stable_sort calls this one. Without it the sanitizer's new would meet the delete below.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size > 0 ? size : 1);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace luxrig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

OutputProgram random_program(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const std::size_t fixtures = 1 + random() % 16, limited = random() % 6;
  OutputProgram program;
  for (std::size_t i = 0; i < fixtures; ++i) {
    program.from_level.push_back(share(random));
    program.to_level.push_back(share(random));
    program.max_level.push_back(share(random));
  }
  program.start = at(100 * share(random));
  program.duration = from_seconds(random() % 4 == 0 ? 0 : 5 * share(random));
  program.curve = random() % 2 ? FadeCurve::linear : FadeCurve::s_curve;
  program.worst_lux_per_level.resize(static_cast<Eigen::Index>(limited), static_cast<Eigen::Index>(fixtures));
  program.max_lx.resize(static_cast<Eigen::Index>(limited));
  for (Eigen::Index row = 0; row < program.max_lx.size(); ++row) {
    const double scale = std::pow(10, 12 * share(random) - 6);
    for (Eigen::Index j = 0; j < program.worst_lux_per_level.cols(); ++j) {
      program.worst_lux_per_level(row, j) = random() % 3 == 0 ? 0 : scale * share(random);
    }
    program.max_lx[row] = random() % 8 == 0 ? 0 : scale * share(random);
  }
  return program;
}

std::vector<double> levels(const OutputProgram& program, Time now) {
  std::vector<double> level(program.from_level.size());
  program.levels_at(now, level);
  return level;
}

TEST(FadeShare, RisesFromZeroToOneAndIsExactAtTheEnds) {
  for (const FadeCurve curve : {FadeCurve::linear, FadeCurve::s_curve}) {
    EXPECT_EQ(fade_share(curve, 0), 0);
    EXPECT_EQ(fade_share(curve, 1), 1);
    EXPECT_EQ(fade_share(curve, -kInfinity), 0);
    EXPECT_EQ(fade_share(curve, kInfinity), 1);
    EXPECT_EQ(fade_share(curve, std::nan("")), 0);
    EXPECT_EQ(fade_share(curve, 0.5), 0.5);
    for (int i = 0; i < 1000; ++i) EXPECT_LT(fade_share(curve, i / 1000.0), fade_share(curve, (i + 1) / 1000.0));
  }
  EXPECT_DOUBLE_EQ(fade_share(FadeCurve::s_curve, 0.25), 3 * 0.0625 - 2 * 0.015625);
}

TEST(DimmerCurve, RisesAndItsInverseReturnsTheLevel) {
  for (const DimmerCurve curve : {DimmerCurve::linear, DimmerCurve::square, DimmerCurve::s_curve}) {
    for (const double end : {0.0, 1.0}) {
      EXPECT_EQ(level_from_drive(curve, end), end);
      EXPECT_EQ(drive_from_level(curve, end), end);
    }
    for (int i = 0; i < 1000; ++i) {
      EXPECT_LT(level_from_drive(curve, i / 1000.0), level_from_drive(curve, (i + 1) / 1000.0));
      EXPECT_LT(drive_from_level(curve, i / 1000.0), drive_from_level(curve, (i + 1) / 1000.0));
    }
    // Relative, down to levels far below one DMX step: dim light is as exact as bright light.
    for (double level = 1; level > 1e-12; level *= 0.9) {
      EXPECT_NEAR(level_from_drive(curve, drive_from_level(curve, level)) / level, 1, 1e-14);
    }
    EXPECT_EQ(drive_from_level(curve, std::nan("")), 0);
    EXPECT_EQ(level_from_drive(curve, std::nan("")), 0);
    EXPECT_EQ(drive_from_level(curve, 2), 1);
    EXPECT_EQ(level_from_drive(curve, -1), 0);
  }
  EXPECT_EQ(level_from_drive(DimmerCurve::square, 0.5), 0.25);
  EXPECT_DOUBLE_EQ(level_from_drive(DimmerCurve::s_curve, 0.25), 0.15625);
  EXPECT_DOUBLE_EQ(drive_from_level(DimmerCurve::s_curve, 0.15625), 0.25);
}

TEST(OutputProgram, NeverExceedsAMaxLevelOrALimitAtAnyInstantOfAnyFade) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> share(-0.2, 1.2);
  for (int i = 0; i < 2000; ++i) {
    const OutputProgram program = random_program(random);
    const auto fixtures = static_cast<Eigen::Index>(program.max_level.size());
    for (int instant = 0; instant < 20; ++instant) {
      const double seconds =
          to_seconds(program.start.time_since_epoch()) + share(random) * to_seconds(program.duration);
      const std::vector<double> level = levels(program, at(seconds));
      for (std::size_t j = 0; j < level.size(); ++j) {
        ASSERT_GE(level[j], 0);
        ASSERT_LE(level[j], program.max_level[j]);
      }
      for (Eigen::Index row = 0; row < program.max_lx.size(); ++row) {
        double forwards = 0, backwards = 0;
        for (Eigen::Index j = 0; j < fixtures; ++j) {
          forwards += program.worst_lux_per_level(row, j) * level[static_cast<std::size_t>(j)];
          const Eigen::Index k = fixtures - 1 - j;
          backwards += program.worst_lux_per_level(row, k) * level[static_cast<std::size_t>(k)];
        }
        ASSERT_LE(forwards, program.max_lx[row]);
        ASSERT_LE(backwards, program.max_lx[row]);
      }
    }
  }
}

TEST(OutputProgram, GivesBothEndsExactlyWhenNoLimitBinds) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 500; ++i) {
    OutputProgram program = random_program(random);
    program.worst_lux_per_level.resize(0, 0);
    program.max_lx.resize(0);
    std::fill(program.max_level.begin(), program.max_level.end(), 1.0);
    EXPECT_EQ(levels(program, program.start + program.duration), program.to_level);
    EXPECT_EQ(levels(program, program.start + std::chrono::hours(1000)), program.to_level);
    const auto& first = program.duration > Duration{} ? program.from_level : program.to_level;
    EXPECT_EQ(levels(program, program.start), first);
    EXPECT_TRUE(program.done(program.start + program.duration));
  }
}

TEST(OutputProgram, MovesEachLevelInOneDirectionOnly) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 200; ++i) {
    OutputProgram program = random_program(random);
    program.max_lx.setConstant(kInfinity);
    program.duration = from_seconds(1);
    std::vector<double> before = levels(program, program.start);
    for (int step = 1; step <= 50; ++step) {
      const std::vector<double> after = levels(program, program.start + from_seconds(step / 50.0));
      for (std::size_t j = 0; j < after.size(); ++j) {
        if (program.to_level[j] >= program.from_level[j]) {
          ASSERT_GE(after[j], before[j]);
        } else {
          ASSERT_LE(after[j], before[j]);
        }
      }
      before = after;
    }
  }
}

TEST(OutputProgram, DimsForALimitMostlyTheLampsThatLightThePoint) {
  OutputProgram program;
  program.from_level = program.to_level = {0.8, 0.8, 0.6};
  program.max_level = {1, 1, 1};
  program.worst_lux_per_level = Eigen::MatrixXd{{100, 2, 0}};  // 80 + 1.6 lx
  program.max_lx = Eigen::VectorXd::Constant(1, 50);
  const std::vector<double> level = levels(program, at(1));
  EXPECT_NEAR(100 * level[0] + 2 * level[1], 50, 1e-9);
  EXPECT_GT(level[1], 0.98 * 0.8);  // it dims by 2 % of the other's share
  EXPECT_LT(level[1], 0.8);
  EXPECT_EQ(level[2], 0.6);
}

TEST(OutputProgram, LightThatIsTooMuchOnlyNowGoesOutEvenly) {
  OutputProgram program;
  program.from_level = program.to_level = {0.8};
  program.max_level = {1};
  program.worst_lux_per_level = Eigen::MatrixXd{{100}};
  program.max_lx = Eigen::VectorXd::Constant(1, 50);
  program.excess_lx = Eigen::VectorXd::Constant(1, 30);  // 80 lx were on
  program.excess_since = at(2);
  EXPECT_NEAR(levels(program, at(1))[0], 0.8, 1e-9);
  EXPECT_NEAR(levels(program, at(2))[0], 0.8, 1e-9);
  EXPECT_NEAR(levels(program, at(2.25))[0], 0.725, 1e-9);
  EXPECT_NEAR(levels(program, at(2.5))[0], 0.65, 1e-9);
  EXPECT_NEAR(levels(program, at(3))[0], 0.5, 1e-9);
  EXPECT_NEAR(levels(program, at(9))[0], 0.5, 1e-9);
  program.to_level = {1};  // what was not on before is not let through
  EXPECT_NEAR(levels(program, at(2))[0], 0.8, 1e-9);
}

TEST(OutputProgram, NoLampGoesOutFasterThanTheExcess) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 300; ++i) {
    OutputProgram program = random_program(random);
    program.to_level = program.from_level;
    program.duration = {};
    for (double& most : program.max_level) most = 1;
    for (std::size_t j = 0; j < program.from_level.size(); ++j)
      program.worth.per_level_squared.push_back(100 * share(random));  // goals need some lamps, and not others
    const Eigen::Map<const Eigen::VectorXd> lit(program.from_level.data(),
                                                static_cast<Eigen::Index>(program.from_level.size()));
    program.excess_lx = (program.worst_lux_per_level * lit - program.max_lx).cwiseMax(0.0);
    program.excess_since = program.start;
    std::vector<double> before = levels(program, program.start);
    for (std::size_t j = 0; j < before.size(); ++j) ASSERT_NEAR(before[j], program.from_level[j], 1e-9);
    for (int tick = 1; tick <= 50; ++tick) {
      const std::vector<double> after = levels(program, program.start + from_seconds(0.02 * tick));
      for (std::size_t j = 0; j < after.size(); ++j) {
        ASSERT_LE(after[j], before[j] + 1e-9);
        ASSERT_GE(after[j], before[j] - 0.02 * program.from_level[j] - 1e-9) << "at tick " << tick;
      }
      before = after;
    }
  }
}

TEST(OutputProgram, DimsForALimitTheLampsThatOtherGoalsNeedLess) {
  OutputProgram program;
  program.from_level = program.to_level = {0.5, 0.5};
  program.max_level = {1, 1};
  program.worst_lux_per_level = Eigen::MatrixXd{{60, 60}};
  program.max_lx = Eigen::VectorXd::Constant(1, 45);
  program.worth.per_level_squared = {0, 76};  // the second lights twenty goals elsewhere: 1 + 76 · 0.25 = 20 times
  const std::vector<double> level = levels(program, at(1));
  EXPECT_NEAR(60 * (level[0] + level[1]), 45, 1e-9);
  EXPECT_NEAR((0.5 - level[1]) / (0.5 - level[0]), 1.0 / 20, 1e-9);
}

TEST(OutputProgram, DimsTheEmittersOfAHousingAlikeToKeepItsColour) {
  OutputProgram program;
  program.from_level = program.to_level = {0.8, 0.2, 0.5};
  program.max_level = {1, 1, 1};
  program.worst_lux_per_level = Eigen::MatrixXd{{100, 10, 40}};
  program.max_lx = Eigen::VectorXd::Constant(1, 50);
  program.worth.housing = {0, 0, 2};
  const std::vector<double> level = levels(program, at(1));
  EXPECT_NEAR(level[0] / level[1], 4, 1e-9);
  EXPECT_NEAR(100 * level[0] + 10 * level[1] + 40 * level[2], 50, 1e-9);
  EXPECT_LT(level[0] / 0.8, level[2] / 0.5);
}

TEST(OutputProgram, PutsOutEveryLampThatReachesAPointWithAZeroLimit) {
  OutputProgram program;
  program.from_level = program.to_level = {0.8, 0.4, 0.6};
  program.max_level = {1, 1, 1};
  program.worst_lux_per_level = Eigen::MatrixXd{{100, 0.01, 0}};
  program.max_lx = Eigen::VectorXd::Zero(1);
  EXPECT_EQ(levels(program, at(1)), (std::vector<double>{0, 0, 0.6}));
}

TEST(OutputProgram, DimsEqualContributorsAlikeAndLeavesTheOthersAlone) {
  OutputProgram program;
  program.from_level = program.to_level = {0.8, 0.4, 0.6};
  program.max_level = {1, 1, 1};
  program.worst_lux_per_level = Eigen::MatrixXd{{50, 100, 0}};  // 40 + 40 lx
  program.max_lx = Eigen::VectorXd::Constant(1, 40);
  const std::vector<double> level = levels(program, at(1));
  EXPECT_NEAR(level[0], 0.4, 1e-12);
  EXPECT_NEAR(level[1], 0.2, 1e-12);
  EXPECT_EQ(level[2], 0.6);
}

TEST(OutputProgram, IsDarkAtOnceInABlackout) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 100; ++i) {
    OutputProgram program = random_program(random);
    program.blackout = true;
    for (const double seconds : {-1.0, 0.0, 0.5, 1.0, 1000.0}) {
      for (const double level : levels(program, program.start + from_seconds(seconds))) EXPECT_EQ(level, 0);
    }
  }
}

TEST(OutputProgram, GivesDarknessNeverNaNForDegenerateInput) {
  const double nan = std::nan("");
  OutputProgram program;
  program.from_level = {nan, 1, -1, 1, kInfinity, 1};
  program.to_level = {1, nan, 1, 1, 1};  // one missing
  program.max_level = {1, 1, 1, nan, 1, 1};
  program.duration = from_seconds(1);
  program.worst_lux_per_level.resize(2, 6);
  program.worst_lux_per_level << nan, 0, 0, 0, kInfinity, 0, 1, 1, 1, 1, 1, 1;
  program.max_lx = Eigen::Vector2d(10, nan);
  for (const double seconds : {-1.0, 0.0, 0.5, 2.0}) {
    for (const double level : levels(program, at(seconds))) {
      EXPECT_TRUE(std::isfinite(level));
      EXPECT_EQ(level, 0);  // the second row's limit is NaN
    }
  }
  program.max_lx[1] = kInfinity;
  const std::vector<double> level = levels(program, at(2));
  EXPECT_EQ(level, (std::vector<double>{0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(levels(OutputProgram{}, at(0)).size(), 0u);
  std::vector<double> more(3, 7.0);
  OutputProgram{}.levels_at(at(0), more);
  EXPECT_EQ(more, (std::vector<double>{0, 0, 0}));
}

TEST(OutputProgram, AllocatesNothing) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 50; ++i) {
    OutputProgram program = random_program(random);
    std::vector<double> level(program.from_level.size());
    const std::size_t before = allocations.load();
    for (int instant = 0; instant < 100; ++instant) {
      program.levels_at(program.start + instant * program.duration / 99, level);
    }
    program.blackout = true;
    program.levels_at(program.start, level);
    EXPECT_EQ(allocations.load(), before);
  }
  const std::size_t before = allocations.load();
  const std::vector<double> one(1);
  EXPECT_GT(allocations.load(), before) << "the counter does not count " << one.data();
}

}  // namespace
}  // namespace luxrig
