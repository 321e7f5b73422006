#include "core/calibration/lamp_steps.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(LampCurve, OfALampThatALimitKeepsLowFollowsTheMakersAbove) {
  const LampCurve curve = curve_of(power_read(2, 0.4, 0.005));
  EXPECT_NEAR(share_at_level(curve.of_level, 0.4), 0.4, 1e-12)
      << "the light at the brightest step is the output's part";
  EXPECT_NEAR(share_at_level(curve.of_level, 0.2), 0.4 * 0.25, 1e-12);
  EXPECT_EQ(share_at_level(curve.of_level, 1), 1);
}

TEST(LampCurve, IsNotFoundFromReadingsThatAreTooUncertain) {
  EXPECT_TRUE(curve_of({}).of_level.empty());
  EXPECT_TRUE(curve_of(power_read(1.7, 1, 0.06)).of_level.empty());
  const std::vector<ReadAtLevel> one{{1, {300, 1}}};
  EXPECT_TRUE(curve_of(one).of_level.empty());
  const std::vector<ReadAtLevel> dark{{1, {0, 0.05}}, {0.5, {0, 0.05}}};
  EXPECT_TRUE(curve_of(dark).of_level.empty());
}

TEST(LampCurve, LeavesOutWhatDoesNotRise) {
  const std::vector<ReadAtLevel> read{{1, {300, 1}}, {0.5, {310, 1}}, {0.25, {60, 0.5}}, {0.25, {50, 0.5}}};
  const LampCurve curve = curve_of(read);
  ASSERT_EQ(curve.of_level.size(), 2U);
  EXPECT_NEAR(curve.of_level.front().second, 0.2, 1e-12);
}

TEST(BrightestLevels, KeepEveryLimitWithLampsAThirdStronger) {
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
  EXPECT_LE(levels[1] * 100 * 1.333, 50);
  EXPECT_GT(levels[1], 0.35);
  EXPECT_EQ(levels[2], 0) << "a switch cannot be dimmed under a limit";
}

}  // namespace
}  // namespace luxrig
