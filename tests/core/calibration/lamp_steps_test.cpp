#include "core/calibration/lamp_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "core/output/dimming.h"

namespace luxrig {
namespace {

/// Light of a dimmer that is a power, read with this relative error.
std::vector<ReadAtLevel> power_read(double exponent, double brightest, double error) {
  std::vector<ReadAtLevel> read;
  for (const double share : kCurveShares) {
    const double level = share * brightest, lux = 300 * std::pow(level, exponent);
    read.push_back({level, {lux, error * lux}});
  }
  return read;
}

TEST(LampCurve, OfAPowerIsThatPowerBetweenItsReadingsToo) {
  for (const double exponent : {0.8, 1.0, 1.7, 2.4}) {
    const LampCurve curve = curve_of(power_read(exponent, 1, 0.005));
    for (const double level : {0.03, 0.07, 0.3, 0.77, 1.0})
      EXPECT_NEAR(share_at_level(curve.of_level, level), std::pow(level, exponent), 1e-9) << exponent << ", " << level;
    EXPECT_NEAR(curve.error, 0.005 * std::sqrt(2.0), 1e-12);
  }
}

TEST(LampCurve, OfALampThatALimitKeepsLowGoesOnAsBelow) {
  for (const double exponent : {0.8, 1.0, 2.0}) {
    const LampCurve curve = curve_of(power_read(exponent, 0.4, 0.005));
    for (const double level : {0.03, 0.2, 0.4}) {
      EXPECT_NEAR(share_at_level(curve.of_level, level), std::pow(level, exponent), 1e-9);
    }
    EXPECT_EQ(share_at_level(curve.of_level, 1), 1);
    EXPECT_NEAR(curve.error_in_use, 0.005 * std::sqrt(2.0), 1e-12) << "used where it was read";
  }
  // What lies above is known the worse, the farther it is.
  double before = curve_of(power_read(2, 0.2, 0.005)).error_in_use;
  for (const double used : {2.0, 5.0, 9.0}) {
    const double error = curve_of(power_read(2, 0.2, 0.005), used).error_in_use;
    EXPECT_NEAR(error, std::hypot(0.005 * std::sqrt(2.0), 0.1 * std::log(std::sqrt(used))), 1e-9) << used;
    EXPECT_GT(error, before);
    before = error;
  }
  EXPECT_NEAR(curve_of(power_read(2, 0.2, 0.005), 1e9).error_in_use,
              curve_of(power_read(2, 0.2, 0.005), 10).error_in_use, 1e-12)
      << "lamps are seldom at more than 0.4 of their light";
}

TEST(LampCurve, IsNotFoundFromReadingsThatAreTooUncertain) {
  EXPECT_TRUE(curve_of({}).of_level.empty());
  EXPECT_TRUE(curve_of(power_read(1.7, 1, 0.06)).of_level.empty());
  const std::vector<ReadAtLevel> one{{1, {300, 1}}};
  EXPECT_TRUE(curve_of(one).of_level.empty());
  const std::vector<ReadAtLevel> dark{{1, {0, 0.05}}, {0.5, {0, 0.05}}};
  EXPECT_TRUE(curve_of(dark).of_level.empty());
}

/// What a dimmer of this law gives, read with noise.
std::vector<ReadAtLevel> read_of(const std::function<double(double)>& share_at, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<ReadAtLevel> read;
  for (const double level : kCurveShares) {
    const double lux = 400 * share_at(level), error_lx = std::hypot(noise * lux, 0.02);
    read.push_back({level, {lux + error_lx * normal(random), error_lx}});
  }
  return read;
}

// Between two levels a power is off by 7 % where the dimmer has a dead band of 4 %.
TEST(LampCurve, FindsDeadBandAndTailOfADimmerThroughNoise) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  double sum = 0;
  int count = 0, near = 0;
  for (int dimmer = 0; dimmer < 500; ++dimmer) {
    const double exponent = 0.8 + 1.6 * unit(random), band = 0.04 * unit(random), tail = 0.01 * unit(random);
    const auto share_at = [&](double level) {
      return tail + (1 - tail) * std::pow((level - band) / (1 - band), exponent);
    };
    const LampCurve curve = curve_of(read_of(share_at, 0.01, random));
    ASSERT_FALSE(curve.of_level.empty());
    for (const double level : {0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 0.9}) {
      if (share_at(level) < 0.005) continue;
      const double off = share_at_level(curve.of_level, level) / share_at(level) - 1;
      sum += off * off;
      near += std::abs(off) < 0.04;
      ++count;
    }
  }
  RecordProperty("rms_off", std::to_string(std::sqrt(sum / count)));
  RecordProperty("within_4_percent", std::to_string(static_cast<double>(near) / count));
  EXPECT_LT(std::sqrt(sum / count), 0.02);
  EXPECT_GT(near, 0.95 * count);
}

TEST(LampCurve, OfADimmerOfAnotherLawStaysAtItsReadings) {
  std::mt19937_64 random(1);
  const auto s_curve = [](double x) { return x * x * (3 - 2 * x); };
  const LampCurve curve = curve_of(read_of(s_curve, 0.001, random));
  for (const double level : kCurveShares) {
    const double exact = s_curve(level), noise = 0.02 / (400 * exact) + 0.001;
    EXPECT_NEAR(share_at_level(curve.of_level, level) / exact, 1, 4 * noise) << level;
  }
}

TEST(LampCurve, LeavesOutWhatDoesNotRise) {
  const std::vector<ReadAtLevel> read{{1, {300, 1}}, {0.5, {310, 1}}, {0.25, {60, 0.5}}, {0.25, {50, 0.5}}};
  const LampCurve curve = curve_of(read);
  ASSERT_FALSE(curve.of_level.empty());
  EXPECT_EQ(curve.of_level.front().first, 0.25);
  EXPECT_NEAR(curve.of_level.front().second, 0.2, 1e-12);
  EXPECT_LT(share_at_level(curve.of_level, 0.5), 0.9);
}

TEST(BrightestLevels, KeepEveryLimitWithLampsHalfAsStrongAgain) {
  Rig rig;
  rig.luminaires.resize(1);
  rig.fixtures.resize(3);
  rig.fixtures[2].switched = true;
  rig.points.resize(2);
  rig.points[1].max_lx = 50;
  Eigen::MatrixXd lux(2, 3);
  lux << 500, 500, 500, 10, 100, 100;
  const auto levels = brightest_levels(rig, lux);
  ASSERT_EQ(levels.size(), 3U);
  EXPECT_EQ(levels[0], 1);
  EXPECT_LE(levels[1] * 100 * 1.5, 50);
  EXPECT_GT(levels[1], 0.25);
  EXPECT_EQ(levels[2], 0) << "a switch cannot be dimmed under a limit";
}

/// 400 rooms with lamps of the field: outputs from 20 % less to 40 % more at a place, light as a power 0.8 to 2.4 of the level.
TEST(LevelsTogether, KeepEveryLimitThroughAnyDimmerOfTheFieldAsEachLampAloneDoes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1), output(0.8, 1.4), exponent(0.8, 2.4);
  double nearest = 0;
  for (int room = 0; room < 400; ++room) {
    const int lamps = 1 + room % 12, points = 1 + room % 5;
    Rig rig;
    rig.luminaires.resize(1);
    rig.fixtures.resize(static_cast<std::size_t>(lamps));
    rig.points.resize(static_cast<std::size_t>(points));
    for (Point& point : rig.points) point.max_lx = 20 + 400 * share(random);
    const Eigen::MatrixXd stated =
        Eigen::MatrixXd::NullaryExpr(points, lamps, [&] { return 600 * std::pow(share(random), 2); });
    const auto alone = brightest_levels(rig, stated), together = levels_together(rig, stated, alone);
    for (int trial = 0; trial < 10; ++trial) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(points);
      for (int f = 0; f < lamps; ++f) {
        const double gain = output(random), power = exponent(random), shallow = 0.8 + 0.05 * share(random);
        const auto light = [&](double level) { return gain * std::pow(level, trial % 2 == 0 ? power : shallow); };
        const auto k = static_cast<std::size_t>(f);
        EXPECT_GT(together[k], 0);
        sum += light(together[k]) * stated.col(f);
        for (int p = 0; p < points; ++p)
          EXPECT_LE(light(alone[k]) * stated(p, f), *rig.points[static_cast<std::size_t>(p)].max_lx);
      }
      for (int p = 0; p < points; ++p) {
        const double of_limit = sum[p] / *rig.points[static_cast<std::size_t>(p)].max_lx;
        EXPECT_LE(of_limit, 1);
        nearest = std::max(nearest, of_limit);
      }
    }
  }
  EXPECT_GT(nearest, 0.7) << "no darker than it has to be";
}

TEST(LevelsTogether, LeaveSwitchesOff) {
  Rig rig;
  rig.luminaires.resize(1);
  rig.fixtures.resize(2);
  rig.fixtures[1].switched = true;
  const auto level = levels_together(rig, Eigen::MatrixXd(0, 2), std::vector<double>{1, 1});
  EXPECT_NEAR(level[0], std::sqrt(0.5), 1e-12);
  EXPECT_EQ(level[1], 0);
}

}  // namespace
}  // namespace luxrig
