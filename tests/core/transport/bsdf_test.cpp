#include "core/transport/bsdf.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/transport/bsdf_fixture.h"

namespace luxrig {
namespace {

using namespace bsdf_fixture;

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

// A coat that absorbs nothing reflects everything, however rough: light that bounces between facets is not lost.
TEST(Bsdf, AFullyReflectingCoatLosesNothing) {
  for (const double roughness : {0.3, 0.6, 1.0})
    for (const double cosine : kCosines)
      EXPECT_NEAR(brute_albedo(Bsdf(glossy(1, roughness, 0.5)), direction(cosine, 0.3)), 1, 0.006)
          << "roughness " << roughness << " cosine " << cosine;
}

// A smooth coat at normal incidence is a mirror of the stated reflectance.
TEST(Bsdf, ASmoothCoatReflectsItsStatedShareAtNormalIncidence) {
  EXPECT_NEAR(Bsdf(glossy(0.04, 0.05, 0.5)).coat_albedo(1), 0.04, 0.0005);
  EXPECT_NEAR(Bsdf(glossy(0.7, 0.05, 0.5)).coat_albedo(1), 0.7, 0.003);
  EXPECT_GT(Bsdf(glossy(0.04, 0.05, 0.5)).coat_albedo(0.05), 0.5) << "Fresnel: nearly all at grazing angles";
}

TEST(Bsdf, FramesAreOrthonormalForAnyNormal) {
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
