#include "core/photometry/sky/daylight_availability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry.h"

namespace luxrig {
namespace {

TEST(DaylightAvailability, IsZeroFromTheHorizonDown) {
  for (const CloudCover cover : {CloudCover::clear, CloudCover::partly, CloudCover::overcast})
    for (const double altitude_rad : {0.0, -1e-9, -0.3, -kPi / 2}) {
      EXPECT_EQ(daylight_availability(cover, altitude_rad).sky_horizontal_lx, 0);
      EXPECT_EQ(daylight_availability(cover, altitude_rad).sun_normal_lx, 0);
    }
}

TEST(DaylightAvailability, HasTheFiguresOfTheRecommendedPractice) {
  const DaylightAvailability clear = daylight_availability(CloudCover::clear, kPi / 2);
  EXPECT_NEAR(clear.sky_horizontal_lx, 16'300, 1e-6);
  EXPECT_NEAR(clear.sun_normal_lx, 127'500 * std::exp(-0.21), 1e-6);
  EXPECT_NEAR(daylight_availability(CloudCover::partly, kPi / 2).sky_horizontal_lx, 45'300, 1e-6);
  EXPECT_NEAR(daylight_availability(CloudCover::overcast, kPi / 6).sky_horizontal_lx, 10'800, 1e-6);
  EXPECT_EQ(daylight_availability(CloudCover::overcast, kPi / 6).sun_normal_lx, 0);
}

TEST(DaylightAvailability, GrowsWithTheSunsHeightAndStaysBelowTheExtraterrestrialSun) {
  for (const CloudCover cover : {CloudCover::clear, CloudCover::partly, CloudCover::overcast}) {
    DaylightAvailability before;
    for (int step = 1; step <= 90; ++step) {
      const DaylightAvailability now = daylight_availability(cover, rad_from_deg(step), 1.034);
      EXPECT_GT(now.sky_horizontal_lx, before.sky_horizontal_lx);
      EXPECT_GE(now.sun_normal_lx, before.sun_normal_lx);
      EXPECT_LT(now.sun_normal_lx, 127'500 * 1.034);
      before = now;
    }
  }
}

TEST(DaylightAvailability, TheSunIsBrightestInEarlyJanuary) {
  EXPECT_NEAR(solar_orbit_factor(2), 1.034, 1e-12);
  EXPECT_NEAR(solar_orbit_factor(184), 0.966, 1e-4);
  for (int day = 1; day <= 366; ++day) EXPECT_LE(std::abs(solar_orbit_factor(day) - 1), 0.034 + 1e-12);
}

}  // namespace
}  // namespace luxrig
