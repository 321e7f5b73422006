#include <gtest/gtest.h>

#include <cmath>

#include "core/highlight/shadow/relief_contrast.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig {
namespace {

constexpr int kFloorSquares = 20;

/// Level, 4 m to a side, centred on the origin, in squares of 20 cm.
struct LevelFloor {
  Scene scene =
      parametric(kFloorSquares, kFloorSquares, [](double u, double v) { return Vec3(4 * u - 2, 4 * v - 2, 0); });
  TargetSurface surface = *make_target_surface(scene);
  TargetRays target{scene};
  std::vector<std::uint32_t> all;
  LevelFloor() {
    for (std::uint32_t i = 0; i < surface.points_m.size(); ++i) all.push_back(i);
  }
};

TEST(MountedContrast, IsIntensityTimesCosineOverSquaredDistance) {
  const LevelFloor floor;
  const double exponent = 3, flux_lm = 500, level = 0.4;
  const Vec3 at(0.3, -0.7, 1.5), aim = Vec3(-0.4, 0.1, -1).normalized();
  const std::vector<MountedBeam> beams = {aimed_beam(at, aim, make_cosine_power(flux_lm, exponent), level)};
  const auto lux = illuminance_lx(floor.surface, floor.target, {}, floor.all, beams, 0, 1);
  const auto expected = [&](const Vec3& point) {
    const Vec3 way = point - at;
    const double along = std::max(0.0, way.normalized().dot(aim));
    const double intensity = level * flux_lm * (exponent + 1) / (2 * kPi) * std::pow(along, exponent);
    return intensity * at.z() / std::pow(way.norm(), 3);
  };
  double contrast = 0;
  for (const std::uint32_t i : floor.all) {
    const double here = expected(floor.surface.point_world_m(i));
    EXPECT_NEAR(lux[i], here, 1e-6 * (1 + here));
    double largest = 0;
    for (const std::uint32_t j : floor.surface.ring(i))
      largest = std::max(largest, std::abs(here - expected(floor.surface.point_world_m(j))));
    contrast += largest / static_cast<double>(floor.all.size());
  }
  const auto measured = relief_contrast(floor.surface, floor.target, {}, floor.all, beams, 0, 1);
  EXPECT_NEAR(measured.local_contrast_lx / contrast, 1, 1e-6);
  EXPECT_EQ(measured.points_with_transition, 0);
  EXPECT_EQ(measured.lit_points, 1);
}

TEST(MountedContrast, OfAFarLightEqualsThatOfADistantOne) {
  const Scene scene = saddle(0.5, 0.4, 24);
  const auto surface = make_target_surface(scene);
  const TargetRays target(scene);
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < surface->points_m.size(); ++i) all.push_back(i);
  const Vec3 direction = Vec3(1, 0.3, 0.2).normalized();
  const double far_m = 1e4;
  const std::vector<DistantBeam> distant = {{direction, 2}};
  // A uniform 2 · far² cd: 2 lx there.
  const std::vector<MountedBeam> mounted = {
      aimed_beam(far_m * direction, -direction, make_isotropic(2 * far_m * far_m * 4 * kPi))};
  const auto a = relief_contrast(*surface, target, all, distant, 0, 1);
  const auto b = relief_contrast(*surface, target, {}, all, mounted, 0, 2);
  EXPECT_GT(a.points_with_transition, 0.05);
  EXPECT_LT(a.lit_points, 0.95);
  EXPECT_NEAR(a.points_with_transition, b.points_with_transition, 0.01);
  EXPECT_NEAR(a.pairs_with_transition, b.pairs_with_transition, 0.01);
  EXPECT_NEAR(a.local_contrast_lx, b.local_contrast_lx, 0.01 * a.local_contrast_lx);
  EXPECT_NEAR(a.lit_points, b.lit_points, 0.01);
}

TEST(MountedContrast, CountsShadowsOfTargetEnvironmentAndPeople) {
  // A lamp 1 m above the floor's middle. A wall from x = 0.5 m on, half as high, shades the floor beyond x = 1 m.
  const LevelFloor floor;
  const std::vector<MountedBeam> beams = {aimed_beam({0.01, 0.01, 1}, -Vec3::UnitZ(), make_lambertian(100))};
  const RayScene wall(parametric(1, 1, [](double u, double v) { return Vec3(0.505, 20 * u - 10, 0.5 * v + 0.0001); }));
  std::vector<std::uint32_t> features;
  for (const std::uint32_t i : floor.all) features.push_back(floor.surface.points_m[i].x() > 0 ? 1 : 0);
  double expected_lit = 0;
  for (const std::uint32_t i : floor.all) {
    const double x = floor.surface.points_m[i].x();
    expected_lit += x < 0.505 || x > 1 + 1e-6 ? 1.0 / static_cast<double>(floor.all.size()) : 0;
  }
  // The wall's top, 0.5 m up at x = 0.505, casts its shadow edge at 0.01 + 0.495 · 2 = 1 m.
  for (const Surroundings& surroundings : {Surroundings{&wall, nullptr}, Surroundings{nullptr, &wall}}) {
    const auto seen = relief_contrast(floor.surface, floor.target, surroundings, floor.all, beams, 0, 1, features);
    EXPECT_NEAR(seen.lit_points, expected_lit, 1.5 * 21 / static_cast<double>(floor.all.size()));
    EXPECT_EQ(seen.features_with_transition, 0.5);
  }
  const auto open = relief_contrast(floor.surface, floor.target, {}, floor.all, beams, 0, 1, features);
  EXPECT_EQ(open.features_with_transition, 0);
  EXPECT_EQ(open.lit_points, 1);
  // The same wall as part of the target.
  const Scene both = joined(
      floor.scene, parametric(1, 1, [](double u, double v) { return Vec3(0.505, 20 * u - 10, 0.5 * v + 0.0001); }));
  const auto own = relief_contrast(floor.surface, TargetRays(both), {}, floor.all, beams, 0, 1, features);
  EXPECT_NEAR(own.lit_points, expected_lit, 1.5 * 21 / static_cast<double>(floor.all.size()));
}

TEST(MountedContrast, ObjectsBehindTheLampShadeNothing) {
  const LevelFloor floor;
  const Scene with_lid = joined(floor.scene, ceiling(5, 1.2));
  const std::vector<MountedBeam> below = {aimed_beam({0, 0, 1}, -Vec3::UnitZ(), make_lambertian(100))};
  const std::vector<MountedBeam> above = {aimed_beam({0, 0, 1.4}, -Vec3::UnitZ(), make_lambertian(100))};
  const TargetRays target(with_lid);
  EXPECT_EQ(relief_contrast(floor.surface, target, {}, floor.all, below, 0, 1).lit_points, 1);
  EXPECT_EQ(relief_contrast(floor.surface, target, {}, floor.all, above, 0, 1).lit_points, 0);
}

TEST(MountedContrast, ABeamEndsWhereItsIntensityDoes) {
  const LevelFloor floor;
  const double half_rad = rad_from_deg(20);  // emission ends at twice half the field angle
  const std::vector<MountedBeam> beams = {
      aimed_beam({0.03, 0.02, 2}, -Vec3::UnitZ(), make_spot(1000, rad_from_deg(10), rad_from_deg(20)))};
  const auto lux = illuminance_lx(floor.surface, floor.target, {}, floor.all, beams, 0, 1);
  for (const std::uint32_t i : floor.all) {
    const Vec3 away = floor.surface.point_world_m(i) - Vec3(0.03, 0.02, 0);
    if (std::abs(away.norm() - 2 * std::tan(half_rad)) < 0.02) continue;
    EXPECT_EQ(lux[i] > 0, away.norm() < 2 * std::tan(half_rad));
  }
}

}  // namespace
}  // namespace luxrig
