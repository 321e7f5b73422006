#include "core/scene/shaft.h"

#include <gtest/gtest.h>

#include <random>

#include "core/scene/ray_scene.h"
#include "tests/random.h"

namespace luxrig {
namespace {

Scene scattered_triangles(double size_m, std::size_t count, Random& random) {
  Scene scene;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 middle = size_m * random.in_cube();
    for (int k = 0; k < 3; ++k) scene.vertices_m.push_back((middle + 0.2 * size_m * random.in_cube()).cast<float>());
    const auto base = static_cast<std::uint32_t>(3 * i);
    scene.triangles.push_back({base, base + 1, base + 2});
  }
  scene.materials.resize(1);
  scene.material_of_triangle.assign(count, 0);
  scene.object_of_triangle.assign(count, 0);
  return scene;
}

TEST(Shaft, ClearShaftsStopNoRayAndBlockedOnesStopAll) {
  Random random(1);
  int clear = 0, blocked = 0, unknown = 0, missed_clear = 0;
  for (int i = 0; i < 2'000; ++i) {
    const double size_m = std::pow(10, random.between(-3, 4));
    Scene scene = scattered_triangles(size_m, i % 3 == 0 ? 3 : 12, random);
    if (i % 2 == 0) scene.origin_world_m = 1e4 * size_m * random.in_cube();
    const Vec3 at = scene.origin_world_m;
    const Vec3 from = at + size_m * random.in_cube(), middle = at + size_m * random.in_cube();
    const Vec3 normal = i % 5 == 0 ? Vec3((middle - from).normalized()) : Vec3(random.in_cube().normalized());
    if (i % 5 == 0) {  // a wall half-way, with four sides of any length
      const Vec3 half = 0.5 * (from + middle) - at, u = normal.unitOrthogonal(), v = normal.cross(u);
      const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        scene.vertices_m.push_back(
            (half + size_m * (a * random.between(0, 0.6) * u + b * random.between(0, 0.6) * v)).cast<float>());
      scene.triangles.push_back({base, base + 1, base + 2});
      scene.triangles.push_back({base, base + 2, base + 3});
      scene.material_of_triangle.assign(scene.triangles.size(), 0);
      scene.object_of_triangle.assign(scene.triangles.size(), 0);
    }
    const RayScene rays(scene);
    const Vec3 x = 0.15 * size_m * random.in_cube(), y = 0.15 * size_m * random.in_cube();
    std::vector<Vec3> corners = {middle - x - y, middle + x - y, middle + x + y, middle - x + y};
    const bool quad = i % 4 != 0;
    if (!quad) {
      const Vec3 z = 0.15 * size_m * random.in_cube();
      for (int k = 0; k < 4; ++k) corners.push_back(corners[static_cast<std::size_t>(k)] + z);
    }
    const Shaft shaft =
        quad ? shaft_to_quad(from, normal, std::span<const Vec3, 4>(corners)) : shaft_to_hull(from, normal, corners);
    std::uint64_t cast = 0;
    const bool is_clear = rays.surely_clear(shaft), is_blocked = rays.surely_blocked(from, normal, corners, cast);
    EXPECT_FALSE(is_clear && is_blocked);
    EXPECT_LE(cast, corners.size());
    int stopped = 0, through = 0;
    for (int k = 0; k < 60; ++k) {
      Vec3 to = Vec3::Zero();  // any place of the hull, often a corner or an edge
      double sum = 0;
      for (const Vec3& corner : corners) {
        const double weight = std::max(0.0, random.between(k % 2 ? -2 : 0, 1));
        to += weight * corner;
        sum += weight;
      }
      if (!(sum > 0)) continue;
      to /= sum;
      if (normal.dot(to - from) <= 0) continue;
      (rays.occluded(from, normal, to) ? stopped : through)++;
    }
    if (is_clear) {
      EXPECT_EQ(stopped, 0) << i;
    }
    if (is_blocked) {
      EXPECT_EQ(through, 0) << i;
    }
    clear += is_clear;
    blocked += is_blocked;
    unknown += !is_clear && !is_blocked;
    missed_clear += !is_clear && stopped == 0 && through > 0;
  }
  EXPECT_GT(clear, 400);
  EXPECT_GT(blocked, 40);
  EXPECT_LT(missed_clear, clear / 3) << "the test is not only safe but of use";
  EXPECT_GT(unknown, 40);
}

TEST(Shaft, TwoTrianglesThatShareAnEdgeBlockOnlyWhatLiesBehindBoth) {
  // A flag folded over its edge, and a quadrilateral with a notch: a line between corners behind one or the other may
  // pass.
  const Vec3 from(0, 0, 0);
  const std::array<Vec3, 3> low = {Vec3(-1, 0, 1), Vec3(1, 0, 1), Vec3(0, -1, 1)};
  const std::array<Vec3, 3> high = {Vec3(-1, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  const std::array<std::array<Vec3, 3>, 2> both = {low, high};
  const std::array<std::size_t, 4> of = {0, 0, 1, 1};
  const std::array<Vec3, 4> near = {Vec3(-0.2, -0.2, 2), Vec3(0.2, -0.2, 2), Vec3(0.2, 0.2, 2), Vec3(-0.2, 0.2, 2)};
  EXPECT_TRUE(hull_lies_behind(from, near, both, of));
  const std::array<Vec3, 4> before = {near[0] / 4, near[1] / 4, near[2] / 4, near[3] / 4};
  EXPECT_FALSE(hull_lies_behind(from, before, both, of)) << "in front";
  const std::array<std::array<Vec3, 3>, 2> folded = {low, {Vec3(-1, 0, 1), Vec3(1, 0, 1), Vec3(0, -0.5, 1.5)}};
  EXPECT_FALSE(hull_lies_behind(from, near, folded, of));
  // Seen at z = 2 the shared edge ends at x = 1; the line between these points passes it at x = 1.5.
  const std::array<std::array<Vec3, 3>, 2> bow = {std::array{Vec3(-1, 0, 1), Vec3(0.5, 0, 1), Vec3(1.5, -1, 1)},
                                                  {Vec3(-1, 0, 1), Vec3(0.5, 0, 1), Vec3(1.5, 1, 1)}};
  const std::array<Vec3, 2> past = {Vec3(1.5, -0.9, 2), Vec3(1.5, 0.9, 2)};
  const std::array<std::size_t, 2> of_past = {0, 1};
  EXPECT_FALSE(hull_lies_behind(from, past, bow, of_past));
}

TEST(Shaft, SurfacesAtItsEndsDoNotBlockIt) {
  // Floor under the point, ceiling flush with the quadrilateral, wall through the point and an edge.
  for (const double size_m : {1e-3, 1.0, 1e4}) {
    Scene scene;
    const auto quad = [&](std::initializer_list<Vec3> corners) {
      const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
      for (const Vec3& corner : corners) scene.vertices_m.push_back((size_m * corner).cast<float>());
      scene.triangles.push_back({base, base + 1, base + 2});
      scene.triangles.push_back({base, base + 2, base + 3});
    };
    quad({{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}});
    quad({{-5, -5, 2.7}, {5, -5, 2.7}, {5, 5, 2.7}, {-5, 5, 2.7}});
    quad({{1, -5, 0}, {1, 5, 0}, {1, 5, 2.7}, {1, -5, 2.7}});
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    const RayScene rays(scene);
    const std::array<Vec3, 4> lamp = {size_m * Vec3(0.2, 0, 2.7), size_m * Vec3(1, 0, 2.7), size_m * Vec3(1, 0.4, 2.7),
                                      size_m * Vec3(0.2, 0.4, 2.7)};
    EXPECT_TRUE(rays.surely_clear(shaft_to_quad(size_m * Vec3(1, -2, 0), Vec3::UnitZ(), lamp)));
    EXPECT_TRUE(rays.surely_clear(shaft_to_quad(size_m * Vec3(-3, 2, 0), Vec3::UnitZ(), lamp)));
    EXPECT_FALSE(rays.surely_clear(shaft_to_quad(size_m * Vec3(2, 2, 0), Vec3::UnitZ(), lamp))) << "beyond the wall";
  }
}

TEST(Shaft, AnEmptySceneIsClearAndAPointInsideAHullIsUndecided) {
  const RayScene empty((Scene()));
  const std::array<Vec3, 8> around = {Vec3(-1, -1, -1), Vec3(1, -1, -1), Vec3(1, 1, -1), Vec3(-1, 1, -1),
                                      Vec3(-1, -1, 1),  Vec3(1, -1, 1),  Vec3(1, 1, 1),  Vec3(-1, 1, 1)};
  const Shaft within = shaft_to_hull(Vec3::Zero(), Vec3::UnitZ(), around);
  EXPECT_TRUE(within.planes.empty());
  EXPECT_TRUE(empty.surely_clear(within));
  Random random(2);
  EXPECT_FALSE(RayScene(scattered_triangles(1, 3, random)).surely_clear(within));
}

}  // namespace
}  // namespace luxrig
