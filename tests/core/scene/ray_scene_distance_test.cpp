// The nearest surface: checked against the distance to a box's walls, and against triangles one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "core/scene/ray_scene.h"
#include "tests/core/transport/boxes.h"

namespace luxrig {
namespace {

constexpr double kAnyDistance_m = std::numeric_limits<double>::infinity();

Scene empty_box(const Vec3& origin_world_m) {
  Scene scene;
  scene.origin_world_m = origin_world_m;
  scene.materials = {Material{}};
  add_box(scene, Vec3::Zero(), Vec3(4, 3, 2.5));
  return scene;
}

double to_walls_m(const Vec3& p) { return std::min({p.x(), 4 - p.x(), p.y(), 3 - p.y(), p.z(), 2.5 - p.z()}); }

TEST(NearestSurface, OfABoxIsItsNearestWall) {
  std::mt19937_64 random(1);
  for (const Vec3& origin_m : {Vec3(0, 0, 0), Vec3(1e6, -1e6, 100)}) {
    const Scene scene = empty_box(origin_m);
    const RayScene rays(scene);
    for (int i = 0; i < 2000; ++i) {
      const auto within = [&](double size) { return std::uniform_real_distribution<double>(0, size)(random); };
      const double x = within(4), y = within(3), z = within(2.5);
      const auto found = rays.nearest_surface(origin_m + Vec3(x, y, z), kAnyDistance_m);
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->distance_m, to_walls_m(Vec3(x, y, z)), 1e-7);
      EXPECT_NEAR((found->position_world_m - origin_m - Vec3(x, y, z)).norm(), found->distance_m, 1e-9);
    }
  }
}

TEST(NearestSurface, FromOutsideCanBeACornerOrAnEdge) {
  const RayScene rays(empty_box(Vec3::Zero()));
  EXPECT_NEAR(rays.nearest_surface(Vec3(-3, -4, -12), kAnyDistance_m)->distance_m, 13, 1e-6);
  EXPECT_NEAR(rays.nearest_surface(Vec3(2, -3, 6.5), kAnyDistance_m)->distance_m, 5, 1e-6);
  EXPECT_EQ(rays.nearest_surface(Vec3(1, 1, 0), kAnyDistance_m)->distance_m, 0);
}

TEST(NearestSurface, IsAbsentBeyondTheBoundOrWithoutTriangles) {
  const RayScene rays(empty_box(Vec3::Zero()));
  EXPECT_FALSE(rays.nearest_surface(Vec3(2, 1.5, 1.2), 1.1));
  EXPECT_TRUE(rays.nearest_surface(Vec3(2, 1.5, 1.2), 1.21));
  EXPECT_FALSE(RayScene(Scene{}).nearest_surface(Vec3::Zero(), kAnyDistance_m));
}

/// Nearest point by another method: the foot on the plane if all three edges have it inside, else on the nearest edge.
double to_triangle_m(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const Vec3 foot = p - normal * (normal.dot(p - a) / normal.squaredNorm());
  double nearest_m = kAnyDistance_m;
  bool inside = true;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    inside = inside && normal.dot((to - from).cross(foot - from)) >= 0;
    const double share = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    nearest_m = std::min(nearest_m, (p - from - share * (to - from)).norm());
  }
  return inside ? (p - foot).norm() : nearest_m;
}

TEST(NearestSurface, OfManyTrianglesIsTheNearestMarkedOne) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> side(-1, 1);
  Scene scene;
  scene.materials = {Material{}};
  for (std::uint32_t t = 0; t < 300; ++t) {
    const Vec3f at(side(random), side(random), side(random));
    for (int i = 0; i < 3; ++i) {
      const float x = side(random), y = side(random), z = side(random);
      scene.vertices_m.push_back(3 * at + Vec3f(x, y, z));
    }
    scene.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    scene.material_of_triangle.push_back(0);
    scene.object_of_triangle.push_back(0);
  }
  const RayScene rays(scene);
  std::vector<std::uint8_t> marks(scene.triangles.size());
  for (auto& mark : marks) mark = random() % 3 == 0 ? 1 : 0;
  for (int i = 0; i < 500; ++i) {
    const float x = side(random), y = side(random), z = side(random);
    const Vec3 p = 4 * Vec3(x, y, z);
    double any_m = kAnyDistance_m, marked_m = kAnyDistance_m;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
      const auto& [a, b, c] = scene.triangles[t];
      const double far_m = to_triangle_m(p, scene.vertex_world_m(a), scene.vertex_world_m(b), scene.vertex_world_m(c));
      any_m = std::min(any_m, far_m);
      if (marks[t]) marked_m = std::min(marked_m, far_m);
    }
    EXPECT_NEAR(rays.nearest_surface(p, kAnyDistance_m)->distance_m, any_m, 1e-9);
    const auto found = rays.nearest_surface(p, kAnyDistance_m, marks);
    EXPECT_NEAR(found->distance_m, marked_m, 1e-9);
    EXPECT_TRUE(marks[found->triangle]);
  }
}

}  // namespace
}  // namespace luxrig
