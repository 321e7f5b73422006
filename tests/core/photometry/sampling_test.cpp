// Directions drawn from distributions: sample() draws with the stated density, the density integrates to one, and
// weights by it give the flux. Every property is checked on every kind of distribution.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "core/photometry/files/ies.h"
#include "core/photometry/intensity.h"
#include "tests/core/photometry/load_files.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

Intensity from_file(const std::string& name) {
  const auto file = load_ies(test::source_folder() / "tests/data/photometry" / name);
  if (!file) {
    ADD_FAILURE() << file.error().front().text();
    return make_isotropic(1);
  }
  return make_intensity(*file);
}

/// One band of angles, falling linearly from one candela value to the other.
Intensity round_band(double from_deg, double to_deg, double from_cd, double to_cd) {
  const auto file = parse_ies(fmt::format("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1 10\n{} {}\n0\n{} {}\n",
                                          from_deg, to_deg, from_cd, to_cd),
                              "band.ies");
  EXPECT_TRUE(file);
  return make_intensity(*file);
}

struct Case {
  const char* name;
  std::function<Intensity()> make;
  double max_variance;  ///< of intensity / density, relative to its mean squared
};

class Sampling : public testing::TestWithParam<Case> {
 protected:
  Intensity light = GetParam().make();
};

Vec3 direction_of(double cosine, double angle) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return {sine * std::cos(angle), sine * std::sin(angle), -cosine};
}

/// Integral of f(direction) over the ring between two angles from -Z, 3-point Gauss in γ, midpoints in azimuth.
template <class F>
double ring_integral(const F& f, double from_rad, double to_rad, double from_azimuth, double to_azimuth, int rings,
                     int spokes) {
  constexpr double kNode[] = {-0.7745966692414834, 0, 0.7745966692414834};
  constexpr double kWeight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const double width = (to_rad - from_rad) / rings;
  const double spoke = (to_azimuth - from_azimuth) / spokes;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    for (int n = 0; n < 3; ++n) {
      const double gamma = from_rad + (i + 0.5 + 0.5 * kNode[n]) * width;
      double of_ring = 0;
      for (int j = 0; j < spokes; ++j) of_ring += f(direction_of(std::cos(gamma), from_azimuth + (j + 0.5) * spoke));
      sum += kWeight[n] * width * std::sin(gamma) * spoke * of_ring;
    }
  }
  return sum;
}

TEST_P(Sampling, DensityIntegratesToOne) {
  // The files' cells have their edges at whole and half degrees, so each ring is smooth; the same for azimuths. Spots
  // are round and may fall off within a tenth of a degree.
  const auto density = [&](const Vec3& d) { return light->density_per_sr(d); };
  const bool spot = std::string_view(GetParam().name).substr(0, 4) == "spot";
  const double whole =
      spot ? ring_integral(density, 0, std::min(kPi, 0.5 * light->emission_cone_rad()), 0, 2 * kPi, 100'000, 1)
           : ring_integral(density, 0, kPi, 0, 2 * kPi, 1440, 144);
  EXPECT_NEAR(whole, 1, 1e-6);
}

TEST_P(Sampling, DrawsWithTheDensityReportedForTheDirection) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 20'000; ++i) {
    const DirectionSample drawn = light->sample(unit(random), unit(random));
    ASSERT_NEAR(drawn.direction.norm(), 1, 1e-12);
    ASSERT_GT(drawn.density_per_sr, 0);
    ASSERT_TRUE(std::isfinite(drawn.density_per_sr));
    ASSERT_NEAR(light->density_per_sr(drawn.direction) / drawn.density_per_sr, 1, 1e-6) << drawn.direction.transpose();
  }
}

TEST_P(Sampling, DistributionMatchesItsDensity) {
  constexpr int kRings = 12, kSpokes = 12, kDraws = 200'000;
  const double half_cone = std::min(kPi, 0.5 * light->emission_cone_rad());
  const auto density = [&](const Vec3& d) { return light->density_per_sr(d); };
  std::vector<double> expected(kRings * kSpokes), seen(kRings * kSpokes);
  for (int r = 0; r < kRings; ++r) {
    for (int s = 0; s < kSpokes; ++s) {
      expected[r * kSpokes + s] = kDraws * ring_integral(density, half_cone * r / kRings, half_cone * (r + 1) / kRings,
                                                         2 * kPi * s / kSpokes, 2 * kPi * (s + 1) / kSpokes, 30, 12);
    }
  }
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < kDraws; ++i) {
    const Vec3 d = light->sample(unit(random), unit(random)).direction;
    const double gamma = std::atan2(std::hypot(d.x(), d.y()), -d.z());
    const double azimuth = std::atan2(d.y(), d.x());
    const int r = std::min(kRings - 1, static_cast<int>(gamma / half_cone * kRings));
    const int s =
        std::min(kSpokes - 1, static_cast<int>((azimuth < 0 ? azimuth + 2 * kPi : azimuth) / (2 * kPi) * kSpokes));
    seen[r * kSpokes + s] += 1;
  }
  // Bins too small for the normal law are merged.
  double chi_square = 0, rest_expected = 0, rest_seen = 0;
  int bins = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 10) {
      rest_expected += expected[i];
      rest_seen += seen[i];
    } else {
      chi_square += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
      ++bins;
    }
  }
  EXPECT_LT(chi_square, bins + 5 * std::sqrt(2.0 * bins));
  EXPECT_NEAR(rest_seen, rest_expected, 5 * std::sqrt(rest_expected + 1));
}

TEST_P(Sampling, WeightedByItsDensityGivesTheFlux) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kDraws = 20'000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const DirectionSample drawn = light->sample(unit(random), unit(random));
    const double share = light->intensity_cd(drawn.direction) / drawn.density_per_sr / light->flux_lm();
    sum += share;
    squares += share * share;
  }
  const double mean = sum / kDraws;
  const double variance = squares / kDraws - mean * mean;
  RecordProperty("relative_variance", std::to_string(variance));
  EXPECT_NEAR(mean, 1, 1e-6 + 5 * std::sqrt(std::max(0.0, variance) / kDraws));
  EXPECT_LE(variance, GetParam().max_variance);
}

TEST_P(Sampling, HasADensityWhereverThereIsLight) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 d = direction_of(2 * unit(random) - 1, 2 * kPi * unit(random));
    if (light->intensity_cd(d) > 0) {
      ASSERT_GT(light->density_per_sr(d), 0) << d.transpose();
    }
  }
}

TEST_P(Sampling, MapsNearbyPointsToNearbyDirections) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  int jumps = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double u = 0.999'999 * unit(random);
    const double v = 0.999'999 * unit(random);
    const Vec3 here = light->sample(u, v).direction;
    const Vec3 near = light->sample(u + 1e-8, v + 1e-8).direction;
    jumps += (here - near).norm() > 1e-3;
  }
  EXPECT_LE(jumps, 2);  // across a gap without light, and where there is next to none
}

TEST_P(Sampling, IsValidOnTheEdgesOfTheSquare) {
  const double below_1 = std::nextafter(1.0, 0.0);
  for (const double u : {0.0, 1e-17, 0.25, 0.5, 0.75, below_1, 1.0}) {
    for (const double v : {0.0, 1e-17, 0.25, 0.5, 0.75, below_1, 1.0}) {
      const DirectionSample drawn = light->sample(u, v);
      EXPECT_NEAR(drawn.direction.norm(), 1, 1e-12) << u << " " << v;
      EXPECT_GT(drawn.density_per_sr, 0) << u << " " << v;
      EXPECT_TRUE(std::isfinite(drawn.density_per_sr)) << u << " " << v;
      EXPECT_TRUE(std::isfinite(light->intensity_cd(drawn.direction))) << u << " " << v;
    }
  }
}

constexpr double kExact = 1e-12;
const Case kCases[] = {
    {"isotropic", [] { return make_isotropic(800); }, kExact},
    {"lambertian", [] { return make_lambertian(800); }, kExact},
    {"cosine_8", [] { return make_cosine_power(800, 8); }, kExact},
    {"cosine_half", [] { return make_cosine_power(800, 0.5); }, kExact},
    {"cylinder", [] { return make_lambertian_cylinder(900, 0.3, 0.8); }, 1e-6},
    {"spot_24_40", [] { return make_spot(1000, rad_from_deg(24), rad_from_deg(40)); }, 1e-5},
    {"spot_1_2", [] { return make_spot(1000, rad_from_deg(1), rad_from_deg(2)); }, 1e-5},
    {"spot_sharp", [] { return make_spot(1000, rad_from_deg(35.9), rad_from_deg(36)); }, 1e-4},
    {"spot_wide", [] { return make_spot(1000, rad_from_deg(60), rad_from_deg(178)); }, 1e-4},
    {"spot_hot", [] { return make_spot(1000, rad_from_deg(4), rad_from_deg(90)); }, 1e-3},
    {"scaled", [] { return scaled_to_flux(make_lambertian(3), 500); }, kExact},
    {"file_round", [] { return from_file("007cfb11e343e2f42e3b476be4ab684e.ies"); }, kExact},
    {"file_half_90_270", [] { return from_file("02a7562c650498ebb301153dbbf59207.ies"); }, kExact},
    {"file_all_round", [] { return from_file("06b4cfdc8805709e767b5e2e904be8ad.ies"); }, kExact},
    {"file_half_0_180", [] { return from_file("trapezoid.ies"); }, kExact},
    {"file_quadrant", [] { return from_file("comet.ies"); }, kExact},
    {"file_beam", [] { return from_file("parallel_beam.ies"); }, kExact},
    {"pencil_down", [] { return round_band(0, 1, 1000, 0); }, kExact},
    {"pencil_up", [] { return round_band(179, 180, 0, 1000); }, kExact},
    {"file_lobes", [] { return from_file("three_lobe_umbrella.ies"); }, kExact},
};
INSTANTIATE_TEST_SUITE_P(Of, Sampling, testing::ValuesIn(kCases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(PencilBeam, HasTheFluxOfItsOnlyBand) {
  // ∫₀ʷ (1 - x / w) sin x dx = 1 - sin w / w, at each pole.
  const double width = rad_from_deg(1);
  const double expected_lm = 2 * kPi * 1000 * (1 - std::sin(width) / width);
  EXPECT_NEAR(round_band(0, 1, 1000, 0)->flux_lm() / expected_lm, 1, 1e-9);
  EXPECT_NEAR(round_band(179, 180, 0, 1000)->flux_lm() / expected_lm, 1, 1e-9);
}

TEST(LambertianCylinder, HasTheFluxOfItsWholeSurface) {
  for (const auto& [d, l] : {std::pair{0.04, 1.2}, {0.5, 0.01}, {0.3, 0.3}}) {
    const Intensity light = make_lambertian_cylinder(700, d, l);
    const auto intensity = [&](const Vec3& direction) { return light->intensity_cd(direction); };
    EXPECT_NEAR(ring_integral(intensity, 0, kPi, 0, 2 * kPi, 2000, 1), 700, 1e-6);
    // Brightest in the direction of the largest outline: tan γ = 4 l / (π d).
    const double gamma = std::atan2(l, kPi / 4 * d);
    EXPECT_NEAR(light->intensity_cd(direction_of(std::cos(gamma), 1)), light->max_intensity_cd(), 1e-9);
  }
}

TEST(CosinePower, HasItsFluxAndPeakInClosedForm) {
  for (const double exponent : {0.0, 0.5, 1.0, 3.0, 40.0, 2000.0}) {
    const Intensity light = make_cosine_power(600, exponent);
    EXPECT_DOUBLE_EQ(light->max_intensity_cd(), 600 * (exponent + 1) / (2 * kPi));
    EXPECT_DOUBLE_EQ(light->intensity_cd(-Vec3::UnitZ()), light->max_intensity_cd());
    EXPECT_NEAR(light->intensity_cd(direction_of(std::cos(0.7), 2)),
                light->max_intensity_cd() * std::pow(std::cos(0.7), exponent), 1e-9);
    EXPECT_EQ(light->intensity_cd(Vec3::UnitZ()), 0);
    const auto intensity = [&](const Vec3& d) { return light->intensity_cd(d); };
    EXPECT_NEAR(ring_integral(intensity, 0, 0.5 * kPi, 0, 2 * kPi, 20'000, 1), 600, 6e-4) << exponent;
  }
  EXPECT_NEAR(make_lambertian(kPi)->max_intensity_cd(), 1, 1e-15);
}

}  // namespace
}  // namespace luxrig
