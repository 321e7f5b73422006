#include "tools/bench/highlight/normals_read.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

const Vec3 kEye(0, 0, 100);

/// A hemisphere seen from its pole.
std::vector<OrientedPoint> dome() {
  std::vector<OrientedPoint> samples;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> up(0.2, 1), around(0, 2 * kPi);
  for (int k = 0; k < 2000; ++k) {
    const double z = up(random), a = around(random), r = std::sqrt(1 - z * z);
    const Vec3 normal(r * std::cos(a), r * std::sin(a), z);
    samples.push_back({normal, normal});
  }
  return samples;
}

/// Light of a distant lamp of 1 lx; a dome casts no shadow on itself but where it faces away.
LampOnSamples distant(const std::vector<OrientedPoint>& samples, const Vec3& towards) {
  LampOnSamples lamp;
  for (const OrientedPoint& sample : samples) {
    lamp.towards.push_back(towards.normalized());
    lamp.facing_lx.push_back(1);
    lamp.lux.push_back(std::max(0.0, sample.normal.dot(towards.normalized())));
  }
  return lamp;
}

double error_deg(const std::vector<OrientedPoint>& samples, const std::vector<Vec3>& towards) {
  std::vector<LampOnSamples> lamps;
  for (const Vec3& one : towards) lamps.push_back(distant(samples, one));
  return deg_from_rad(error_of_read_normals(samples, kEye, lamps, 1));
}

TEST(NormalsRead, InTheDarkEverythingFacesTheEye) {
  const std::vector<OrientedPoint> samples = dome();
  double tilt_rad = 0;
  for (const OrientedPoint& sample : samples)
    tilt_rad += std::acos(sample.normal.dot((kEye - sample.position_world_m).normalized()));
  EXPECT_NEAR(error_deg(samples, {}), deg_from_rad(tilt_rad / 2000), 1e-9);
}

TEST(NormalsRead, ThreeLampsThatAllSeeItReadItToTheNoise) {
  // Around the top, all three lamps shine on it. An error of the values of σ / E turns a normal by about as much.
  std::vector<OrientedPoint> top = dome();
  std::erase_if(top, [](const OrientedPoint& sample) { return sample.normal.z() < 0.8; });
  const double error = error_deg(top, {{1, 0, 1}, {-0.5, 0.866, 1}, {-0.5, -0.866, 1}});
  EXPECT_LT(error, 5);
  EXPECT_GT(error, 0.5) << "2 % of noise cannot vanish";
}

TEST(NormalsRead, MoreIsReadFromTheSideThanFromTheEye) {
  const std::vector<OrientedPoint> samples = dome();
  const double dark = error_deg(samples, {}), from_eye = error_deg(samples, {{0, 0, 1}}),
               aside = error_deg(samples, {{1, 0, 1}}), both = error_deg(samples, {{1, 0, 1}, {-1, 0, 1}}),
               four = error_deg(samples, {{1, 0, 1}, {-1, 0, 1}, {0, 1, 1}, {0, -1, 1}});
  EXPECT_LT(aside, dark);
  EXPECT_LT(aside, from_eye) << "a lamp at the eye cannot tell left from right";
  EXPECT_LT(both, aside);
  EXPECT_LT(four, 0.6 * both) << "they tell up from down, too";
}

TEST(NormalsRead, LampsInOnePlaceTellNoMoreThanOne) {
  const std::vector<OrientedPoint> samples = dome();
  EXPECT_NEAR(error_deg(samples, {{1, 0, 1}, {1, 0, 1}}), error_deg(samples, {{1, 0, 1}}), 2);
}

}  // namespace
}  // namespace luxrig
