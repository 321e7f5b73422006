#include "core/highlight/surface/interest_points.h"

#include <gtest/gtest.h>

#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

struct Prepared {
  TargetSurface surface;
  std::vector<Curvature> curvature;
};

Prepared prepared(const Scene& scene, double radius_m) {
  auto surface = make_target_surface(scene);
  auto curvature = curvature_of(*surface, {{}, radius_m});
  EXPECT_TRUE(curvature);
  return {*surface, *curvature};
}

std::vector<std::uint32_t> found(const Prepared& p, const InterestOptions& options) {
  const auto points = interest_points(p.surface, p.curvature, options);
  EXPECT_TRUE(points);
  return *points;
}

/// A plate with a round groove of 1 m radius, 0.1 m wide at half depth.
Scene grooved_plate() {
  return parametric(160, 160, [](double u, double v) {
    const double x = 4 * u - 2, y = 4 * v - 2, off = (std::hypot(x, y) - 1) / 0.1;
    return Vec3(x, y, -0.06 * std::exp(-off * off));
  });
}

TEST(InterestPoints, LieInTheGroove) {
  const Prepared p = prepared(grooved_plate(), 0.1);
  InterestOptions options;
  options.wanted_share = 0.03;
  const auto points = found(p, options);
  ASSERT_GT(points.size(), 100u);
  double area_m2 = 0;
  for (const std::uint32_t i : points) {
    EXPECT_NEAR(std::hypot(p.surface.points_m[i].x(), p.surface.points_m[i].y()), 1, 0.08);
    area_m2 += p.surface.areas_m2[i];
  }
  EXPECT_NEAR(area_m2, 0.03 * p.surface.area_m2(), 0.002 * p.surface.area_m2());
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
}

TEST(InterestPoints, LieBelowACurvatureThreshold) {
  const Prepared p = prepared(grooved_plate(), 0.1);
  InterestOptions options;
  options.mean_curvature_below_per_m = -2;
  const auto points = found(p, options);
  std::size_t below = 0;
  for (const Curvature& c : p.curvature)
    if (c.known() && c.mean_per_m() < -2) ++below;
  EXPECT_GT(points.size(), below * 9 / 10);
  for (const std::uint32_t i : points) EXPECT_LT(p.curvature[i].mean_per_m(), -2);
}

TEST(InterestPoints, AreFoundAtTheSamePlacesAtAnySize) {
  InterestOptions options;
  options.wanted_share = 0.03;
  const auto one = found(prepared(grooved_plate(), 0.1), options);
  for (const double scale : {0.00025, 250.0}) {  // 1 mm, 1 km
    const auto other =
        found(prepared(transformed(grooved_plate(), scale, Mat3::Identity(), Vec3::Zero()), 0.1 * scale), options);
    std::vector<std::uint32_t> both;
    std::set_intersection(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(both));
    EXPECT_GT(both.size(), one.size() * 98 / 100);
  }
}

TEST(InterestPoints, AreAbsentWhereNothingIsRecessed) {
  for (const Scene& scene : {uv_sphere(1, 60), saddle(1e6, 1, 40), noisy(saddle(1e6, 1, 80), 0.002, 1), Scene{}}) {
    const Prepared p = prepared(scene, 0.2);
    InterestOptions options;
    options.wanted_share = 1;
    // On a noisy plane chance makes 2.5 % look recessed by two standard errors.
    EXPECT_LE(found(p, options).size(), p.surface.points_m.size() * 4 / 100);
  }
}

TEST(InterestPoints, StaySpreadOverTheFeatureWhenThinnedOut) {
  const Prepared p = prepared(grooved_plate(), 0.1);
  InterestOptions options;
  options.wanted_share = 0.03;
  options.max_points = 60;
  const auto points = found(p, options);
  EXPECT_LE(points.size(), 60u);
  EXPECT_GE(points.size(), 40u);
  std::array<int, 8> octants{};
  for (const std::uint32_t i : points) {
    const Vec3& at = p.surface.points_m[i];
    ++octants[static_cast<std::size_t>(std::min(7.0, (std::atan2(at.y(), at.x()) + kPi) / (2 * kPi) * 8))];
  }
  for (const int count : octants) EXPECT_GE(count, 3);
}

TEST(InterestPoints, RefuseInvalidOptions) {
  const Prepared p = prepared(uv_sphere(1, 10), 0.5);
  InterestOptions options;
  options.mean_curvature_below_per_m = 1;
  EXPECT_FALSE(interest_points(p.surface, p.curvature, options));
  options = {};
  options.wanted_share = 1.5;
  EXPECT_FALSE(interest_points(p.surface, p.curvature, options));
  EXPECT_FALSE(interest_points(p.surface, {}, {}));
}

TEST(ReliefTargets, MatchTheirDescription) {
  const Scene relief = make_carved_relief(0.01);
  const auto surface = make_target_surface(relief);
  ASSERT_TRUE(surface);
  // Closed: each edge has as many triangles one way as the other.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : surface->triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = t[i], b = t[(i + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  for (const auto& [edge, balance] : edges) ASSERT_EQ(balance, 0);
  double volume_m3 = 0;
  for (const auto& t : surface->triangles)
    volume_m3 += surface->points_m[t[0]].dot(surface->points_m[t[1]].cross(surface->points_m[t[2]])) / 6;
  EXPECT_GT(volume_m3, 0.5 * 1.2 * 0.8 * 0.08);
  EXPECT_LT(volume_m3, 1.2 * 0.8 * 0.08 * 1.3);

  const auto terrain = make_target_surface(make_terrain(100, 40));
  ASSERT_TRUE(terrain);
  EXPECT_EQ(terrain->points_m.size(), 41u * 41u);
  for (const Vec3& normal : terrain->normals) EXPECT_GT(normal.z(), 0.2);
}

}  // namespace
}  // namespace luxrig
