#include "core/photometry/beam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/photometry/files/ies.h"
#include "tests/core/photometry/load_files.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

TEST(Beam, OfASpotHasTheAnglesItWasMadeWith) {
  for (const auto& [beam_deg, field_deg] : {std::pair{1.0, 2.0}, {24.0, 40.0}, {35.9, 36.0}, {60.0, 178.0}}) {
    const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(field_deg));
    EXPECT_NEAR(deg_from_rad(beam_angles(*spot).c0_rad), beam_deg, 1e-6);
    EXPECT_NEAR(deg_from_rad(beam_angles(*spot).c90_rad), beam_deg, 1e-6);
    EXPECT_NEAR(deg_from_rad(field_angles(*spot).c0_rad), field_deg, 1e-6);
  }
}

TEST(Beam, HasClosedFormsForCosinePowersAndIsotropicLight) {
  for (const double n : {1.0, 2.0, 30.0}) {
    const Intensity light = make_cosine_power(100, n);
    EXPECT_NEAR(beam_angles(*light).c0_rad, 2 * std::acos(std::pow(0.5, 1 / n)), 1e-8);
    EXPECT_NEAR(field_angles(*light).c90_rad, 2 * std::acos(std::pow(0.1, 1 / n)), 1e-8);
  }
  EXPECT_NEAR(beam_angles(*make_isotropic(5)).c0_rad, 2 * kPi, 1e-9);
}

TEST(Beam, IsCountedFromTheBrightestDirectionOfEachPlane) {
  // A wall washer: 100 cd at γ = 60° in C0, falling linearly to 0 at 20° and 80°; dim elsewhere.
  const auto file = parse_ies(
      "IES:LM-63-2019\nTILT=NONE\n1 -1 1 5 5 1 2 0 0 0\n1 1 9\n0 20 60 80 90\n0 90 180 270 360\n"
      "0 0 100 0 0\n0 0 30 0 0\n0 0 0 0 0\n0 0 30 0 0\n0 0 100 0 0\n",
      "washer.ies");
  ASSERT_TRUE(file.has_value());
  const Intensity washer = make_intensity(*file);
  EXPECT_NEAR(deg_from_rad(beam_angles(*washer).c0_rad), 30, 1e-6);   // 40° to 70°
  EXPECT_EQ(beam_angles(*washer).c90_rad, 0);                         // never reaches 50 cd
  EXPECT_NEAR(deg_from_rad(field_angles(*washer).c0_rad), 54, 1e-6);  // 24° to 78°
  EXPECT_NEAR(deg_from_rad(angles_to_share(*washer, 0.3).c90_rad), 0, 1e-6);
  EXPECT_NEAR(deg_from_rad(angles_to_share(*washer, 0.15).c90_rad), 30, 1e-6);
}

TEST(ConeOfFlux, HasClosedFormsForCosinePowersAndIsotropicLight) {
  for (const double share : {0.1, 0.5, 0.9, 0.999}) {
    EXPECT_NEAR(cone_of_flux_rad(*make_isotropic(7), share), 2 * std::acos(1 - 2 * share), 1e-5);
    for (const double n : {1.0, 5.0, 200.0}) {
      EXPECT_NEAR(cone_of_flux_rad(*make_cosine_power(7, n), share), 2 * std::acos(std::pow(1 - share, 1 / (n + 1))),
                  1e-5)
          << n << " " << share;
    }
  }
  EXPECT_NEAR(cone_of_flux_rad(*make_lambertian(7), 0.9), 2 * std::asin(std::sqrt(0.9)), 1e-5);
}

TEST(ConeOfFlux, OfANarrowGaussianFollowsItsTail) {
  // Within γ a Gaussian holds 1 - 2^-(γ/b)². It is cut off at twice its field angle and re-scaled by a thousandth.
  const double beam = rad_from_deg(4);
  const Intensity spot = make_spot(1000, beam, beam * std::sqrt(std::log2(10.0)));
  EXPECT_NEAR(cone_of_flux_rad(*spot, 0.5) / beam, 1, 0.03);
  EXPECT_LT(cone_of_flux_rad(*spot, 0.9), cone_of_flux_rad(*spot, 0.99));
  EXPECT_LE(cone_of_flux_rad(*spot, 1), spot->emission_cone_rad() + 1e-9);
}

TEST(ConeOfFlux, HoldsTheShareInAMeasuredFile) {
  const auto file = load_ies(test::source_folder() / "tests/data/photometry/trapezoid.ies");
  ASSERT_TRUE(file.has_value());
  const Intensity light = make_intensity(*file);
  const double half = 0.5 * cone_of_flux_rad(*light, 0.9);
  double inside = 0;
  constexpr int kRings = 600, kSpokes = 180;
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kSpokes; ++j) {
      const double gamma = half * (i + 0.5) / kRings;
      const double c = 2 * kPi * (j + 0.5) / kSpokes;
      inside += light->intensity_cd({std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma)}) *
                std::sin(gamma);
    }
  }
  EXPECT_NEAR(inside * half / kRings * 2 * kPi / kSpokes / light->flux_lm(), 0.9, 1e-4);
}

}  // namespace
}  // namespace luxrig
