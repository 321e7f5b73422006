#include "core/photometry/sky/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace luxrig {
namespace {

Vec3 towards(double azimuth_deg, double altitude_deg) {
  const double a = rad_from_deg(azimuth_deg), h = rad_from_deg(altitude_deg);
  return {std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)};
}

/// Illuminance on a plane, by midpoints over the sky: independent of sampling and of the sky's own scaling.
double illuminance_lx(const SkyLuminance& sky, const Vec3& normal, int steps = 900) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double zenith = 0.5 * kPi * (i + 0.5) / steps;
    double ring = 0;
    for (int j = 0; j < 2 * steps; ++j) {
      const double azimuth = kPi * (j + 0.5) / steps;
      const Vec3 d(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth), std::cos(zenith));
      ring += sky.luminance_cd_m2(d) * std::max(0.0, d.dot(normal));
    }
    sum += ring * std::sin(zenith);
  }
  return sum * (0.5 * kPi / steps) * (kPi / steps);
}

TEST(OvercastSky, HasTheClosedFormsOfMoonAndSpencer) {
  const Sky sky = make_overcast_sky(10'000);
  const double zenith_cd_m2 = sky->luminance_cd_m2(Vec3::UnitZ());
  EXPECT_NEAR(7 * kPi / 9 * zenith_cd_m2 / 10'000, 1, 1e-9);
  EXPECT_NEAR(sky->luminance_cd_m2(Vec3::UnitX()) / zenith_cd_m2, 1.0 / 3, 1e-12);
  EXPECT_NEAR(sky->luminance_cd_m2(towards(10, 30)) / zenith_cd_m2, 2.0 / 3, 1e-12);
  EXPECT_EQ(sky->luminance_cd_m2(towards(0, -0.1)), 0);
  EXPECT_EQ(sky->horizontal_illuminance_lx(), 10'000);
  EXPECT_NEAR(illuminance_lx(*sky, Vec3::UnitZ()) / 10'000, 1, 1e-5);
  // A wall sees  Lz (π/6 + 4/9) = E · 3 (3π + 8) / (42 π) = 0.396 E.
  EXPECT_NEAR(illuminance_lx(*sky, Vec3::UnitX()) / 10'000, 3 * (3 * kPi + 8) / (42 * kPi), 1e-5);
  EXPECT_NEAR(3 * (3 * kPi + 8) / (42 * kPi), 0.396, 5e-4);
}

TEST(UniformSky, HasIlluminanceOfPiTimesItsLuminance) {
  const Sky sky = make_uniform_sky(5000);
  EXPECT_NEAR(sky->luminance_cd_m2(towards(33, 5)), 5000 / kPi, 1e-9);
  EXPECT_NEAR(illuminance_lx(*sky, Vec3::UnitX()) / 5000, 0.5, 1e-5);
  const Sky type_5 = make_general_sky(5, towards(0, 40), 5000);
  EXPECT_NEAR(type_5->luminance_cd_m2(towards(200, 60)) / sky->luminance_cd_m2(Vec3::UnitZ()), 1, 1e-6);
}

TEST(GeneralSky, HasTheStandardRatiosToTheZenith) {
  // Independent calculation for type 12 (CIE clear) with the sun at 40°, at 20° altitude and 90° of azimuth from the
  // sun.
  const Sky clear = make_clear_sky(towards(0, 40), 12'000);
  const Vec3 d = towards(90, 20);
  const double chi = std::acos(d.dot(towards(0, 40)));
  const double zs = rad_from_deg(50);
  const auto indicatrix = [](double x) {
    return 1 + 10 * (std::exp(-3 * x) - std::exp(-1.5 * kPi)) + 0.45 * std::cos(x) * std::cos(x);
  };
  const double expected =
      (1 - std::exp(-0.32 / std::sin(rad_from_deg(20)))) * indicatrix(chi) / ((1 - std::exp(-0.32)) * indicatrix(zs));
  EXPECT_NEAR(clear->luminance_cd_m2(d) / clear->luminance_cd_m2(Vec3::UnitZ()), expected, 1e-9);
  // The older clear sky has 0.91 instead of 1 - 10 e^(-3π/2).
  EXPECT_NEAR(indicatrix(1.0), 0.91 + 10 * std::exp(-3.0) + 0.45 * std::cos(1.0) * std::cos(1.0), 5e-4);
  // Type 1 approaches the overcast sky: its horizon has 1 / (1 + 4 e^-0.7) of the zenith's luminance.
  const Sky type_1 = make_general_sky(1, towards(0, 40), 12'000);
  EXPECT_NEAR(type_1->luminance_cd_m2(towards(77, 0)) / type_1->luminance_cd_m2(Vec3::UnitZ()),
              1 / (1 + 4 * std::exp(-0.7)), 1e-9);
}

class GeneralSkies : public testing::TestWithParam<int> {};

TEST_P(GeneralSkies, HaveTheirHorizontalIlluminanceForAnySunPosition) {
  for (const double altitude : {0.5, 12.0, 45.0, 89.9, 90.0}) {
    const Sky sky = make_general_sky(GetParam(), towards(30, altitude), 20'000);
    EXPECT_NEAR(illuminance_lx(*sky, Vec3::UnitZ(), 300) / 20'000, 1, 1e-4) << altitude;
  }
}

TEST_P(GeneralSkies, ShineAndAreSampledEverywhereAboveTheHorizon) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const Sky sky = make_general_sky(GetParam(), towards(-70, 25), 20'000);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 d = towards(360 * unit(random), 90 * unit(random));
    ASSERT_GT(sky->luminance_cd_m2(d), 0);
    ASSERT_GT(sky->density_per_sr(d), 0);
    ASSERT_EQ(sky->luminance_cd_m2(-d), 0);
    ASSERT_EQ(sky->density_per_sr(-d), 0);
  }
}

TEST_P(GeneralSkies, GiveTheirIlluminanceWhenWeightedByTheirDensity) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const Sky sky = make_general_sky(GetParam(), towards(200, 35), 20'000);
  constexpr int kDraws = 20'000;
  double sum = 0, squares = 0, share_sum = 0, share_squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const DirectionSample drawn = sky->sample(unit(random), unit(random));
    ASSERT_NEAR(drawn.direction.norm(), 1, 1e-12);
    ASSERT_NEAR(sky->density_per_sr(drawn.direction) / drawn.density_per_sr, 1, 1e-6);
    const double luminance = sky->luminance_cd_m2(drawn.direction) / drawn.density_per_sr;
    const double lx = luminance * drawn.direction.z();
    sum += lx;
    squares += lx * lx;
    share_sum += luminance;
    share_squares += luminance * luminance;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 20'000, 5 * std::sqrt((squares / kDraws - mean * mean) / kDraws));
  const double share = share_sum / kDraws;
  const double variance = share_squares / kDraws / (share * share) - 1;
  RecordProperty("relative_variance", std::to_string(variance));
  EXPECT_LT(variance, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Types, GeneralSkies, testing::Range(1, kGeneralSkyTypes + 1));

TEST(Skies, SampleDirectionsAsTheirDensityStates) {
  const Sky skies[] = {make_uniform_sky(1), make_overcast_sky(1), make_clear_sky(towards(100, 30), 1),
                       make_general_sky(15, towards(-20, 3), 1)};
  for (const Sky& sky : skies) {
    constexpr int kRings = 10, kSpokes = 16, kDraws = 100'000, kFine = 24;
    std::vector<double> expected(kRings * kSpokes), seen(kRings * kSpokes);
    double whole = 0;
    for (int r = 0; r < kRings * kFine; ++r) {
      for (int s = 0; s < kSpokes * kFine; ++s) {
        const double z = (r + 0.5) / (kRings * kFine);
        const double azimuth = 2 * kPi * (s + 0.5) / (kSpokes * kFine);
        const double sine = std::sqrt(1 - z * z);
        const double part = sky->density_per_sr({sine * std::cos(azimuth), sine * std::sin(azimuth), z}) * 2 * kPi /
                            (kRings * kFine * kSpokes * kFine);
        expected[static_cast<std::size_t>((r / kFine) * kSpokes + s / kFine)] += kDraws * part;
        whole += part;
      }
    }
    EXPECT_NEAR(whole, 1, 1e-4);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < kDraws; ++i) {
      const Vec3 d = sky->sample(unit(random), unit(random)).direction;
      const double turn = std::atan2(d.y(), d.x()) / (2 * kPi);
      const int r = std::min(kRings - 1, static_cast<int>(d.z() * kRings));
      const int s = std::min(kSpokes - 1, static_cast<int>((turn < 0 ? turn + 1 : turn) * kSpokes));
      seen[static_cast<std::size_t>(r * kSpokes + s)] += 1;
    }
    double chi_square = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      chi_square += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
    }
    const double bins = kRings * kSpokes;
    EXPECT_LT(chi_square, bins + 5 * std::sqrt(2 * bins));
  }
}

TEST(Sun, GivesItsNormalIlluminanceTimesTheSineOfItsAltitude) {
  for (const double altitude : {1.0, 20.0, 62.0, 90.0}) {
    const Vec3 axis = towards(50, altitude);
    const Sky sun = make_sun(axis, 90'000);
    EXPECT_NEAR(sun->horizontal_illuminance_lx(), 90'000 * std::sin(rad_from_deg(altitude)), 1e-6);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    double normal = 0, level = 0;
    constexpr int kDraws = 20'000;
    for (int i = 0; i < kDraws; ++i) {
      const DirectionSample drawn = sun->sample(unit(random), unit(random));
      ASSERT_NEAR(drawn.direction.norm(), 1, 1e-12);
      ASSERT_GT(sun->luminance_cd_m2(drawn.direction), 0);
      ASSERT_EQ(sun->density_per_sr(drawn.direction), drawn.density_per_sr);
      ASSERT_LE(std::acos(std::min(1.0, drawn.direction.dot(axis))), 0.5 * kSunDiameter_rad + 1e-7);
      normal += sun->luminance_cd_m2(drawn.direction) / drawn.density_per_sr * drawn.direction.dot(axis) / kDraws;
      level += sun->luminance_cd_m2(drawn.direction) / drawn.density_per_sr * drawn.direction.z() / kDraws;
    }
    EXPECT_NEAR(normal / 90'000, 1, 1e-6);
    EXPECT_NEAR(level / sun->horizontal_illuminance_lx(), 1, altitude > 10 ? 1e-3 : 5e-3);
    EXPECT_EQ(sun->luminance_cd_m2(towards(51, std::min(altitude, 80.0))), 0);
  }
}

TEST(Sun, HalvedByTheHorizonShinesWithItsUpperHalf) {
  const Sky sun = make_sun(towards(0, 1e-9), 1000);
  // Half disk of radius r; its moment about the horizon is L · 2r³/3.
  const double r = 0.5 * kSunDiameter_rad;
  EXPECT_NEAR(sun->horizontal_illuminance_lx() / (1000 / (kPi * r * r) * 2 * r * r * r / 3), 1, 1e-3);
  EXPECT_EQ(sun->luminance_cd_m2(towards(0, -0.1)), 0);
  EXPECT_GT(sun->luminance_cd_m2(towards(0, 0.1)), 0);
}

TEST(SkyDeath, AbortsOnImpossibleRequests) {
  EXPECT_DEATH((void)make_general_sky(16, Vec3::UnitZ(), 1), "sky type 16");
  EXPECT_DEATH((void)make_clear_sky(towards(0, -1), 1), "sun at");
  EXPECT_DEATH((void)make_overcast_sky(0), "0 lx");
}

}  // namespace
}  // namespace luxrig
