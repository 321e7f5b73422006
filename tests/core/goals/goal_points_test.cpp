#include "core/goals/goal_points.h"

#include <gtest/gtest.h>

#include "tests/core/goals/built_scene.h"

namespace luxrig {
namespace {

/// A floor of 6 × 4 m; on its far half 300 lx, on the near half 100 lx, and in the middle of that a soft spot.
struct PaintedFloor {
  PaintedFloor() {
    const Vec3 up = Vec3::UnitZ();
    Painting painting(surface, rays);
    painting.add({StrokeKind::selective, {{{1.5, 2, 0}, up}}, 100, 0, 0});
    painting.add({StrokeKind::selective, {{{4.5, 2, 0}, up}}, 300, 0, 0});
    painting.add({StrokeKind::brush, {{{1.2, 2, 0}, up}}, 200, 0.8, 0.9});
    lux.assign(painting.lux().begin(), painting.lux().end());
  }
  Scene scene = BuiltScene().sheet({0, 0, 0}, {6, 0, 0}, {0, 4, 0}).scene();
  RayScene rays{scene};
  SurfacePatches surface = *make_surface_patches(scene, rays, {0.06, 1});
  std::vector<float> lux;
};

TEST(GoalPoints, AreApartByTheirSpacingAndLeaveNoGap) {
  const PaintedFloor floor;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GoalSampling sampling{0.12, 0.9, 0.2, seed};
    const std::vector<double> spacing_m = spacing_of(floor.surface, floor.lux, sampling);
    const std::vector<GoalPoint> points = goal_points(floor.surface, floor.lux, {"floor", 400, 2}, sampling);
    std::vector<double> spacing_of_point_m;
    double weights = 0, area = 0;
    for (const GoalPoint& point : points) {
      const auto patch = patch_at(floor.surface, floor.rays, point.place);
      ASSERT_TRUE(patch);
      EXPECT_EQ(floor.surface.position_world_m(*patch), point.place.position_world_m);
      EXPECT_EQ(floor.lux[*patch], static_cast<float>(point.goal_lx));
      EXPECT_EQ(point.max_lx, 400);
      EXPECT_NEAR(point.place.normal_world.z(), 1, 1e-6);
      spacing_of_point_m.push_back(spacing_m[*patch]);
      weights += point.weight;
      area += point.area_m2;
    }
    EXPECT_NEAR(weights, 2.0 * static_cast<double>(points.size()), 1e-6 * weights);
    EXPECT_NEAR(area, 24, 1e-3);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GE((points[i].place.position_world_m - points[j].place.position_world_m).norm() + 1e-6,
                  std::max(spacing_of_point_m[i], spacing_of_point_m[j]));
    for (std::uint32_t p = 0; p < floor.surface.size(); ++p) {
      if (std::isnan(floor.lux[p])) continue;
      double nearest_m = 1e9;
      for (const GoalPoint& point : points)
        nearest_m = std::min(nearest_m, (point.place.position_world_m - floor.surface.position_world_m(p)).norm());
      EXPECT_LT(nearest_m, 2.2 * spacing_m[p]) << "ways along links are up to 8 % longer than straight";
    }
  }
}

TEST(GoalPoints, AreDenseOnlyWhereTheGoalHasDetail) {
  const PaintedFloor floor;
  const GoalSampling sampling{0.12, 0.9, 0.2, 1};
  const std::vector<double> spacing_m = spacing_of(floor.surface, floor.lux, sampling);
  for (std::uint32_t p = 0; p < floor.surface.size(); ++p) {
    const Vec3 at = floor.surface.position_world_m(p);
    if (std::isnan(floor.lux[p])) {
      EXPECT_TRUE(std::isinf(spacing_m[p]));
      continue;
    }
    if (std::abs(at.x() - 3) < 0.03) {
      EXPECT_LT(spacing_m[p], 0.16) << "the border between both halves";
    }
    if (at.x() > 5.2) {
      EXPECT_EQ(spacing_m[p], 0.9) << "even light";
    }
    for (const PatchLink& link : floor.surface.links_of(p))
      EXPECT_LE(spacing_m[link.patch],
                spacing_m[p] + 0.5 * (at - floor.surface.position_world_m(link.patch)).norm() + 1e-6);
  }
  std::size_t even = 0, detailed = 0;
  for (const GoalPoint& point : goal_points(floor.surface, floor.lux, {"floor", {}, 1}, sampling)) {
    even += point.place.position_world_m.x() > 4.5;
    detailed += std::abs(point.place.position_world_m.x() - 1.2) < 0.75;
  }
  EXPECT_GT(even, 4u);
  EXPECT_GT(detailed, 2 * even);
}

TEST(GoalPoints, WithoutPaintThereIsNone) {
  const PaintedFloor floor;
  const std::vector<float> bare(floor.surface.size(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(goal_points(floor.surface, bare, {"floor", {}, 1}, {}).empty());
  // Dark everywhere is a goal, too, and has no detail.
  const std::vector<float> dark(floor.surface.size(), 0);
  for (const double spacing_m : spacing_of(floor.surface, dark, {0.1, 0.7, 0.2, 1})) EXPECT_EQ(spacing_m, 0.7);
}

}  // namespace
}  // namespace luxrig
