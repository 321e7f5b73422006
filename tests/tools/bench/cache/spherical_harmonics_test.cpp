#include "tools/bench/cache/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

/// Integral over the sphere: mean over a grid of directions, times 4π. Exact in azimuth, midpoint rule in height.
template <class F>
auto integral_over_sphere(const F& f) {
  constexpr int kLevels = 600, kTurns = 64;
  decltype(f(Vec3::UnitZ())) sum = f(Vec3::UnitZ()) * 0;
  for (int i = 0; i < kLevels; ++i)
    for (int j = 0; j < kTurns; ++j) {
      const double z = (2 * i + 1.0) / kLevels - 1, phi = 2 * kPi * (j + 0.5) / kTurns, r = std::sqrt(1 - z * z);
      sum += f(Vec3(r * std::cos(phi), r * std::sin(phi), z)) * (4 * kPi / (kLevels * kTurns));
    }
  return sum;
}

Vec3 any_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

TEST(SphericalHarmonics, AreOrthonormal) {
  using Gram = Eigen::Matrix<double, 9, 9>;
  const Gram gram = integral_over_sphere([](const Vec3& d) -> Gram { return harmonics(d) * harmonics(d).transpose(); });
  EXPECT_LT((gram - Gram::Identity()).cwiseAbs().maxCoeff(), 3e-5);
}

TEST(SphericalHarmonics, CosineLobeIsTheProjectionOfTheClampedCosine) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 axis = any_direction(random);
    const Harmonics projected =
        integral_over_sphere([&](const Vec3& d) -> Harmonics { return harmonics(d) * std::max(0.0, d.dot(axis)); });
    EXPECT_LT((projected - cosine_lobe(axis)).cwiseAbs().maxCoeff(), 2e-3);
    // Three orders contain 99.2 % of the lobe's energy, 2π/3.
    EXPECT_NEAR(cosine_lobe(axis).squaredNorm() / (2 * kPi / 3), 0.9922, 1e-4);
  }
}

TEST(SphericalHarmonics, UniformRadianceGivesPiTimesItOnEveryPlane) {
  std::mt19937 random(2);
  Harmonics even = Harmonics::Zero();
  even[0] = 3 * std::sqrt(4 * kPi);  // L = 3 in every direction
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(cosine_lobe(any_direction(random)).dot(even), 3 * kPi, 1e-12);
}

TEST(SphericalHarmonics, IlluminanceMatchesNumericIntegration) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    Harmonics radiance;
    for (int k = 0; k < 9; ++k) radiance[k] = normal(random);
    const Vec3 axis = any_direction(random);
    const double lux =
        integral_over_sphere([&](const Vec3& d) { return radiance.dot(harmonics(d)) * std::max(0.0, d.dot(axis)); });
    EXPECT_NEAR(cosine_lobe(axis).dot(radiance), lux, 1e-2);
  }
}

TEST(SphericalHarmonics, ARotatedPairGivesTheSameProduct) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const Vec3 a = any_direction(random), b = any_direction(random);
    const Mat3 turn = Eigen::AngleAxisd(i, any_direction(random)).toRotationMatrix();
    EXPECT_NEAR(harmonics(a).dot(cosine_lobe(b)), harmonics(turn * a).dot(cosine_lobe(turn * b)), 1e-12);
  }
}

}  // namespace
}  // namespace luxrig
