/// relief_lights: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/distant/relief_lights.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/distant/relief_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace relief_lights_fixture;

TEST(LitTable, SearchMatchesEveryRayWithFewerRays) {
  for (const Scene& scene : {make_carved_relief(0.02), make_terrain(100, 60), torus(1, 0.7, 60, 40)}) {
    const ReliefStudy study = studied(scene, 150);
    const ContrastSamples samples = one_ring_samples(study.surface, study.interest);
    const LitTable every = table_of(study, samples, 16, true), found = table_of(study, samples, 16, false);
    std::uint64_t lit = 0, wrong = 0, facing = 0;
    for (std::size_t i = 0; i < every.rows.size(); ++i) {
      lit += static_cast<std::uint64_t>(std::popcount(every.rows[i]));
      wrong += static_cast<std::uint64_t>(std::popcount(every.rows[i] ^ found.rows[i]));
    }
    for (std::size_t p = 0; p < samples.points.size(); ++p)
      for (std::uint32_t b = 0; b < every.bins.count(); ++b)
        facing += samples.points[p].normal.dot(every.bins.direction_of(b)) > 0 ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(every.rays), static_cast<double>(facing), 0.001 * static_cast<double>(facing));
    EXPECT_GT(lit, every.rays / 10);
    EXPECT_LT(static_cast<double>(wrong), 0.005 * static_cast<double>(lit));
    EXPECT_LT(found.rays, every.rays / 2);
  }
}

TEST(ReliefLights, ASingleLightMatchesTheBestOfAllDirections) {
  for (const Scene& scene : {make_terrain(100, 50), make_carved_relief(0.02)}) {
    const ReliefStudy study = studied(scene, 100);
    ReliefLightOptions options;
    options.side = 5;
    options.spread_rad = 0;
    const ReliefLightSearch search = searched(study, options);
    const DirectionBins bins(options.side);
    double best_lx = 0;
    for (std::uint32_t b = 0; b < bins.count(); ++b) {
      const double lx = contrast_by_rays(study, {bins.direction_of(b)});
      EXPECT_NEAR(search.of_each_bin()[b], lx, 0.03) << b;
      best_lx = std::max(best_lx, lx);
    }
    const auto one = search.lights(1);
    ASSERT_TRUE(one);
    EXPECT_GE(one->local_contrast_lx, 0.98 * best_lx);
    EXPECT_LE(one->local_contrast_lx, 1.02 * best_lx);
  }
}

TEST(ReliefLights, TurnWithTheObjectAndTolerateScannerNoise) {
  const Scene terrain = make_terrain();
  const auto one_light = [](const Scene& scene) {
    const ReliefStudy study = studied(scene, 3000);
    return searched(study, {}).lights(1)->directions.at(0);
  };
  const auto degrees = [](const Vec3& a, const Vec3& b) {
    return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
  };
  const Vec3 wanted = one_light(terrain);
  const Mat3 rotation = Eigen::AngleAxisd(rad_from_deg(67), Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  Scene turned = terrain;
  for (Vec3f& v : turned.vertices_m) v = (rotation * v.cast<double>()).cast<float>();
  EXPECT_LT(degrees(rotation.transpose() * one_light(turned), wanted), 5);
  // 0.1 % of its size, 14 cm, on triangles of 62 cm.
  Scene noisy = terrain;
  Random random(1);
  const double sigma_m = 0.001 * make_target_surface(terrain)->size_m();
  for (Vec3f& v : noisy.vertices_m) {
    double sum = 0;  // of six: much like a normal distribution
    for (int k = 0; k < 6; ++k) sum += random.between(-1, 1);
    v.z() += static_cast<float>(sigma_m * sum / std::sqrt(2));
  }
  EXPECT_LT(degrees(one_light(noisy), wanted), 5);
}

TEST(ReliefLights, ComeFromThePreferredSideWhereTheObjectAllowsIt) {
  // A bowl in level ground: all sides are equally good.
  const ReliefStudy study = studied(parametric(120, 120,
                                               [](double u, double v) {
                                                 const double x = 4 * u - 2, y = 4 * v - 2;
                                                 return Vec3(x, y, -0.5 * std::exp(-(x * x + y * y) / 0.32));
                                               }),
                                    0);
  const auto plain = searched(study, {}).lights(1);
  ASSERT_TRUE(plain);
  for (const double azimuth_deg : {10.0, 100.0, 235.0}) {
    ReliefLightOptions options;
    options.preference = 0.1;  // samples make the sides of the bowl differ by some 2 %
    options.preferred = Vec3(std::cos(rad_from_deg(azimuth_deg)), std::sin(rad_from_deg(azimuth_deg)), 0.5);
    const auto one = searched(study, options).lights(1);
    ASSERT_TRUE(one);
    const Vec3& direction = one->directions[0];
    const double off_deg = deg_from_rad(std::atan2(direction.y(), direction.x())) - azimuth_deg;
    EXPECT_LT(std::abs(std::remainder(off_deg, 360)), 45) << azimuth_deg;
    EXPECT_GT(one->local_contrast_lx, (1 - options.preference) * plain->local_contrast_lx);
  }
}

}  // namespace
}  // namespace luxrig
