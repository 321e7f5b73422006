#include "core/photometry/intensity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace luxrig {
namespace {

Vec3 at_gamma(double gamma_rad, double c_rad = 0.3) {
  return {std::sin(gamma_rad) * std::cos(c_rad), std::sin(gamma_rad) * std::sin(c_rad), -std::cos(gamma_rad)};
}

/// Flux of a round distribution by the midpoint rule: an independent check, good to about 1e-8.
double summed_round_flux_lm(const IntensityDistribution& of, double to_rad) {
  constexpr int kRings = 100'000;
  const double step = to_rad / kRings;
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    const double gamma = (i + 0.5) * step;
    sum += of.intensity_cd(at_gamma(gamma)) * std::sin(gamma);
  }
  return 2 * kPi * sum * step;
}

TEST(Isotropic, GivesFluxOverFourPiEverywhere) {
  const Intensity bulb = make_isotropic(800);
  EXPECT_DOUBLE_EQ(bulb->intensity_cd(Vec3::UnitZ()), 800 / (4 * kPi));
  EXPECT_DOUBLE_EQ(bulb->intensity_cd(-Vec3::UnitX()), 800 / (4 * kPi));
  EXPECT_DOUBLE_EQ(bulb->flux_lm(), 800);
  EXPECT_DOUBLE_EQ(bulb->max_intensity_cd(), 800 / (4 * kPi));
  EXPECT_DOUBLE_EQ(bulb->emission_cone_rad(), 2 * kPi);
  EXPECT_NEAR(summed_round_flux_lm(*bulb, kPi), 800, 1e-6);
}

struct Angles {
  double beam_deg, field_deg;
};
class SpotProfile : public testing::TestWithParam<Angles> {};

TEST_P(SpotProfile, HasHalfAtTheBeamAngleAndATenthAtTheFieldAngle) {
  const auto [beam_deg, field_deg] = GetParam();
  const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(field_deg));
  const double peak_cd = spot->intensity_cd(-Vec3::UnitZ());
  EXPECT_DOUBLE_EQ(peak_cd, spot->max_intensity_cd());
  // A small angle loses about 1e-16/γ of its accuracy on the way through a direction vector.
  EXPECT_NEAR(spot->intensity_cd(at_gamma(0.5 * rad_from_deg(beam_deg))) / peak_cd, 0.5, 1e-10);
  EXPECT_NEAR(spot->intensity_cd(at_gamma(0.5 * rad_from_deg(field_deg))) / peak_cd, 0.1, 1e-10);
}

TEST_P(SpotProfile, IntegratesToItsFlux) {
  const auto [beam_deg, field_deg] = GetParam();
  const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(field_deg));
  EXPECT_NEAR(summed_round_flux_lm(*spot, rad_from_deg(field_deg)), 1000, 1e-4);
}

TEST_P(SpotProfile, FallsSteadilyAndIsDarkBeyondTheFullFieldAngle) {
  const auto [beam_deg, field_deg] = GetParam();
  const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(field_deg));
  double before_cd = spot->max_intensity_cd();
  for (double gamma_deg = 0; gamma_deg <= 180; gamma_deg += 0.05) {
    const double now_cd = spot->intensity_cd(at_gamma(rad_from_deg(gamma_deg)));
    EXPECT_LE(now_cd, before_cd * (1 + 1e-12));
    EXPECT_GE(now_cd, 0);
    if (gamma_deg > field_deg + 1e-6) {
      EXPECT_EQ(now_cd, 0) << gamma_deg;
    }
    before_cd = now_cd;
  }
  EXPECT_GE(spot->emission_cone_rad(), std::min(2.0, field_deg / 90) * rad_from_deg(90));
}

INSTANTIATE_TEST_SUITE_P(FromPinSpotToFlood, SpotProfile,
                         testing::Values(Angles{24, 40}, Angles{1, 2}, Angles{6, 60}, Angles{35.9, 36}, Angles{60, 178},
                                         Angles{90, 120}, Angles{10, 20}, Angles{120, 179.9}, Angles{1, 40},
                                         Angles{0.1, 170}));

/// ∫ I/I0 dΩ of the profile in the header, by Simpson's rule in ln (γ/b)^p. Below the first step it counts as 1.
double profile_sr(double beam_rad, double field_rad) {
  constexpr int kSteps = 20'000;
  const double b = beam_rad / 2, f = field_rad / 2, p = std::log(std::log2(10.0)) / std::log(f / b);
  const double from = -60, to = std::min(p * std::log(2 * f / b), 7.1);  // 2^-e^7.1 underflows
  const double step = (to - from) / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = from + i * step, gamma_rad = b * std::exp(s / p), t = gamma_rad / f - 1;
    const double w = t <= 0 ? 1 : std::max(0.0, 1 - 6 * std::pow(t, 5) + 15 * std::pow(t, 4) - 10 * std::pow(t, 3));
    sum += (i == 0 || i == kSteps ? 1 : i % 2 ? 4 : 2) * std::exp2(-std::exp(s)) * w * std::sin(gamma_rad) * gamma_rad;
  }
  return 2 * kPi * (sum * step / 3 / p + 2 * std::pow(std::sin(b * std::exp(from / p) / 2), 2));
}

/// A narrow beam in a wide field with nearly all light outside the beam: this search once never ended.
TEST(Spot, HasThePeakThatItsFluxGivesForAnyTwoAngles) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 300; ++i) {
    const double beam_deg = 0.001 * std::pow(179 / 0.001, share(random));
    const double ratio = 1 + std::pow(10, -6 + 11 * share(random));
    const double field_deg = std::min(beam_deg * ratio, 179.9);
    const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(field_deg));
    EXPECT_NEAR(spot->max_intensity_cd() * profile_sr(rad_from_deg(beam_deg), rad_from_deg(field_deg)) / 1000, 1, 1e-5)
        << beam_deg << "° in " << field_deg << "°";
  }
}

TEST(Spot, IsAGaussianForAGaussiansRatioOfAngles) {
  const double ratio = std::sqrt(std::log2(10.0));
  const double beam_rad = rad_from_deg(2);
  const Intensity spot = make_spot(1000, beam_rad, beam_rad * ratio);
  const double half_rad = 0.5 * beam_rad;
  const double at_quarter_cd = spot->intensity_cd(at_gamma(0.5 * half_rad));
  EXPECT_NEAR(at_quarter_cd / spot->max_intensity_cd(), std::exp2(-0.25), 1e-9);
  // A narrow Gaussian holds I0 π b² / ln 2 in all (sin γ ≈ γ), nine tenths of it above a tenth of its peak.
  const double whole_lm = spot->max_intensity_cd() * kPi * half_rad * half_rad / std::log(2.0);
  EXPECT_NEAR(summed_round_flux_lm(*spot, half_rad * ratio) / (0.9 * whole_lm), 1, 1e-4);
}

TEST(Scaled, KeepsTheShapeAndHasTheFlux) {
  const Intensity narrow = make_spot(900, 0.4, 0.7);
  const Intensity doubled = scaled_to_flux(narrow, 1800);
  EXPECT_DOUBLE_EQ(doubled->flux_lm(), 1800);
  EXPECT_DOUBLE_EQ(doubled->max_intensity_cd(), 2 * narrow->max_intensity_cd());
  EXPECT_DOUBLE_EQ(doubled->emission_cone_rad(), narrow->emission_cone_rad());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> gamma(0, kPi);
  for (int i = 0; i < 100; ++i) {
    const Vec3 direction = at_gamma(gamma(random));
    EXPECT_DOUBLE_EQ(doubled->intensity_cd(direction), 2 * narrow->intensity_cd(direction));
  }
}

TEST(IntensityDeath, AbortsOnImpossibleRequests) {
  EXPECT_DEATH((void)make_spot(100, 0.5, 0.5), "beam 0.5 rad, field 0.5 rad");
  EXPECT_DEATH((void)make_isotropic(-1), "flux -1 lm");
  EXPECT_DEATH((void)scaled_to_flux(nullptr, 1), "no distribution");
}

}  // namespace
}  // namespace luxrig
