#include "core/photometry/sky/sun_position.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxrig {
namespace {

TEST(SunPosition, MatchesThePublishedExampleOfTheSolarPositionAlgorithm) {
  // Reda and Andreas, NREL/TP-560-34302, appendix A.5: 17 October 2003, 12:30:30 at UTC-7, 39.742476° N, 105.1786° W;
  // azimuth 194.34024°, elevation without refraction 39.872046°.
  const SunPosition sun =
      sun_position({2003, 10, 17, 19.0 + 30.5 / 60}, rad_from_deg(39.742476), rad_from_deg(-105.1786));
  EXPECT_NEAR(deg_from_rad(sun.azimuth_rad), 194.34024, 0.01);
  EXPECT_NEAR(deg_from_rad(sun.altitude_rad), 39.872046, 0.01);
}

TEST(SunPosition, HasTheDeclinationOfMeeusExample25a) {
  // 1992 October 13, 0h: declination -7.78507°. At the pole that is the altitude (less parallax), at any longitude.
  for (const double longitude_deg : {-120.0, 0.0, 77.0}) {
    const SunPosition sun = sun_position({1992, 10, 13, 0}, 0.5 * kPi, rad_from_deg(longitude_deg));
    EXPECT_NEAR(deg_from_rad(sun.altitude_rad), -7.78507 - 8.794 / 3600, 2e-4);
  }
}

TEST(SunPosition, IsOverTheTropicAtSolsticeAndTheEquatorAtEquinox) {
  // June solstice of 2024: 20 June 20:51 UTC; March equinox of 2024: 20 March 03:06 UTC (almanac).
  EXPECT_NEAR(deg_from_rad(sun_position({2024, 6, 20, 20.85}, 0.5 * kPi, 0).altitude_rad), 23.436, 0.01);
  EXPECT_NEAR(deg_from_rad(sun_position({2024, 3, 20, 3.1}, 0.5 * kPi, 0).altitude_rad), 0, 0.01);
}

TEST(SunPosition, IsSouthAtNoonEastInTheMorningAndMirroredInTheSouthernHemisphere) {
  const double north = rad_from_deg(50);
  // True noon at Greenwich on 15 April is within a minute of 12:00 UTC (the equation of time is 0).
  EXPECT_NEAR(deg_from_rad(sun_position({2023, 4, 15, 12}, north, 0).azimuth_rad), 180, 0.5);
  EXPECT_LT(deg_from_rad(sun_position({2023, 4, 15, 7}, north, 0).azimuth_rad), 120);
  EXPECT_GT(deg_from_rad(sun_position({2023, 4, 15, 17}, north, 0).azimuth_rad), 240);
  const double azimuth_deg = deg_from_rad(sun_position({2023, 4, 15, 12}, -north, 0).azimuth_rad);
  EXPECT_LT(std::min(azimuth_deg, 360 - azimuth_deg), 0.5);
  EXPECT_LT(sun_position({2023, 4, 15, 0}, north, 0).altitude_rad, 0);
}

TEST(SunPosition, CountsHoursPastMidnightIntoTheNextDay) {
  const SunPosition a = sun_position({2024, 2, 28, 30}, 0.3, 1.0);
  const SunPosition b = sun_position({2024, 2, 29, 6}, 0.3, 1.0);
  EXPECT_NEAR(a.azimuth_rad, b.azimuth_rad, 1e-9);
  EXPECT_NEAR(a.altitude_rad, b.altitude_rad, 1e-9);
}

TEST(TowardsSky, HasNorthAlongYAndEastAlongXUnlessRotated) {
  EXPECT_NEAR((towards_sky_world(0, 0) - Vec3::UnitY()).norm(), 0, 1e-15);
  EXPECT_NEAR((towards_sky_world(0.5 * kPi, 0) - Vec3::UnitX()).norm(), 0, 1e-15);
  EXPECT_NEAR((towards_sky_world(1, 0.5 * kPi) - Vec3::UnitZ()).norm(), 0, 1e-15);
  // With north a quarter turn counter-clockwise of +Y, it lies along -X.
  EXPECT_NEAR((towards_sky_world(0, 0, 0.5 * kPi) + Vec3::UnitX()).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace luxrig
