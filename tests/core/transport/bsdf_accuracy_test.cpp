/// bsdf: accuracy over many samples.
#include <gtest/gtest.h>

#include <random>

#include "core/transport/bsdf.h"
#include "tests/core/transport/bsdf_fixture.h"

namespace luxrig {
namespace {

using namespace bsdf_fixture;

// The coat reflects Es, the body reflects ρ of the rest. All light that is not absorbed comes out.
TEST(Bsdf, ReflectsTheCoatsShareAndTheBodysShareOfTheRest) {
  for (const double roughness : {0.3, 0.6, 1.0})
    for (const double specular : {0.04, 0.5}) {
      const Bsdf bsdf(glossy(specular, roughness, 0.8));
      for (const double cosine : kCosines) {
        const double coat = bsdf.coat_albedo(cosine);
        EXPECT_NEAR(brute_albedo(bsdf, direction(cosine, 0.3)), coat + 0.8 * (1 - coat), 0.006)
            << "roughness " << roughness << " specular " << specular << " cosine " << cosine;
      }
    }
}

TEST(Bsdf, SamplesByItsStatedDensity) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double roughness : {0.2, 0.5, 1.0}) {
    const Bsdf bsdf(glossy(0.2, roughness, 0.5));
    for (const double cosine : kCosines) {
      const Vec3 out = direction(cosine, 1);
      // The mean of a function over samples is the integral of function times density: here for cos³ and the albedo.
      double mean = 0, albedo = 0, expected = 0;
      constexpr int kSamples = 200'000;
      for (int i = 0; i < kSamples; ++i) {
        const auto s = bsdf.sample(Vec3::UnitZ(), out, unit(random), unit(random), unit(random));
        if (!(s.density_per_sr > 0)) continue;
        EXPECT_NEAR(s.in.norm(), 1, 1e-9);
        mean += s.in.z() * s.in.z() * s.in.z() / kSamples;
        albedo += s.weight_rgb.x() / kSamples;
      }
      constexpr int kGrid = 800;
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          const Vec3 in = direction((i + 0.5) / kGrid, 2 * kPi * (j + 0.5) / kGrid);
          expected += in.z() * in.z() * in.z() * bsdf.density(Vec3::UnitZ(), out, in);
        }
      expected *= 2 * kPi / (double{kGrid} * kGrid);
      EXPECT_NEAR(mean, expected, 0.006) << roughness << ' ' << cosine;
      const double coat = bsdf.coat_albedo(cosine);
      EXPECT_NEAR(albedo, coat + 0.5 * (1 - coat), 0.006) << roughness << ' ' << cosine;
    }
  }
}

}  // namespace
}  // namespace luxrig
