#include "core/transport/bsdf.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

Material glossy(double specular, double roughness, double body) {
  Material material{"varnish", Vec3::Constant(body)};
  material.specular_reflectance = specular;
  material.roughness = roughness;
  return material;
}

Vec3 direction(double cosine, double angle_rad) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(angle_rad), sine * std::sin(angle_rad), cosine};
}

/// ∫ f cosθ dω over the hemisphere by a fine grid in cosine and angle, apart from all sampling.
double brute_albedo(const Bsdf& bsdf, const Vec3& out) {
  constexpr int kCosines = 1000, kAngles = 1000;
  double sum = 0;
  for (int i = 0; i < kCosines; ++i)
    for (int j = 0; j < kAngles; ++j) {
      const double cosine = (i + 0.5) / kCosines;
      sum += bsdf.value(Vec3::UnitZ(), out, direction(cosine, 2 * kPi * (j + 0.5) / kAngles)).x() * cosine;
    }
  return sum * 2 * kPi / (double{kCosines} * kAngles);
}

const double kCosines[] = {1.0, 0.8, 0.4, 0.1};

TEST(Bsdf, AMattSurfaceIsLambertian) {
  const Bsdf bsdf(Material{"paint", Vec3(0.2, 0.5, 0.7)});
  EXPECT_TRUE(bsdf.matt());
  EXPECT_EQ(bsdf.value(Vec3::UnitZ(), direction(0.3, 1), direction(0.9, 4)), Vec3(Vec3(0.2, 0.5, 0.7) / kPi));
  EXPECT_EQ(bsdf.value(Vec3::UnitZ(), direction(0.3, 1), -direction(0.9, 4)), Vec3::Zero()) << "light from behind";
  EXPECT_DOUBLE_EQ(bsdf.density(Vec3::UnitZ(), direction(0.3, 1), direction(0.9, 4)), 0.9 / kPi);
}

TEST(Bsdf, IsReciprocal) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> cosine(0.01, 1), angle(0, 2 * kPi);
  for (const double roughness : {0.1, 0.3, 0.9}) {
    const Bsdf bsdf(glossy(0.04, roughness, 0.5));
    for (int i = 0; i < 1000; ++i) {
      const Vec3 a = direction(cosine(random), angle(random)), b = direction(cosine(random), angle(random));
      const double there = bsdf.value(Vec3::UnitZ(), a, b).x(), back = bsdf.value(Vec3::UnitZ(), b, a).x();
      EXPECT_NEAR(there, back, 1e-12 * there);
      EXPECT_GE(there, 0);
    }
  }
}

// The coat takes Es of the light and the body ρ of the rest: what goes in and is not absorbed comes out.
TEST(Bsdf, ReflectsTheCoatsShareAndTheBodysOfTheRest) {
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

// A coat that absorbs nothing sends all on, however rough: what one facet throws on another is not lost.
TEST(Bsdf, ACoatThatReflectsAllLosesNothing) {
  for (const double roughness : {0.3, 0.6, 1.0})
    for (const double cosine : kCosines)
      EXPECT_NEAR(brute_albedo(Bsdf(glossy(1, roughness, 0.5)), direction(cosine, 0.3)), 1, 0.006)
          << "roughness " << roughness << " cosine " << cosine;
}

// A smooth coat at normal incidence is a mirror of the stated reflectance.
TEST(Bsdf, ASmoothCoatReflectsItsStatedShareStraightOn) {
  EXPECT_NEAR(Bsdf(glossy(0.04, 0.05, 0.5)).coat_albedo(1), 0.04, 0.0005);
  EXPECT_NEAR(Bsdf(glossy(0.7, 0.05, 0.5)).coat_albedo(1), 0.7, 0.003);
  EXPECT_GT(Bsdf(glossy(0.04, 0.05, 0.5)).coat_albedo(0.05), 0.5) << "Fresnel: nearly all at grazing angles";
}

TEST(Bsdf, SamplesByTheDensityItStates) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double roughness : {0.2, 0.5, 1.0}) {
    const Bsdf bsdf(glossy(0.2, roughness, 0.5));
    for (const double cosine : kCosines) {
      const Vec3 out = direction(cosine, 1);
      // The mean of a function over samples is its integral times density: here cos³ and the albedo.
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

TEST(Bsdf, FramesAreOrthonormalWhereverTheNormalPoints) {
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.6, 0, -0.8), Vec3(1e-9, 0, -1)}) {
    const Frame frame(n.normalized());
    Mat3 columns;
    columns << frame.tangent, frame.bitangent, frame.normal;
    EXPECT_TRUE((columns.transpose() * columns).isIdentity(1e-9)) << n.transpose();
    EXPECT_NEAR(columns.determinant(), 1, 1e-9);
  }
}

}  // namespace
}  // namespace luxrig
