#include "tools/bench/cache/volume/voxelise.h"

#include <gtest/gtest.h>

#include <random>

#include "tools/bench/cache/volume/voxel_walk.h"

namespace luxrig {
namespace {

Scene scene_of(const std::vector<std::array<Vec3f, 3>>& triangles) {
  Scene scene;
  for (const auto& t : triangles) {
    const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
    scene.vertices_m.insert(scene.vertices_m.end(), t.begin(), t.end());
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.material_of_triangle.push_back(0);
  }
  scene.materials.resize(1);
  return scene;
}

/// Visits points spread over each triangle, including corners and edges, each with the box of voxels it may lie in.
template <class Check>
void for_each_surface_point(const Scene& scene, int steps, Check&& check) {
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertices_m[t[0]].cast<double>(), b = scene.vertices_m[t[1]].cast<double>(),
               c = scene.vertices_m[t[2]].cast<double>();
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) check(a + (b - a) * i / steps + (c - a) * j / steps);
  }
}

TEST(Voxelise, EverySurfacePointLiesInASetVoxel) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const double scale : {1e-3, 1.0, 1e4}) {
    for (int round = 0; round < 60; ++round) {
      std::vector<std::array<Vec3f, 3>> triangles;
      for (int i = 0; i < 8; ++i) {
        std::array<Vec3f, 3> t;
        for (Vec3f& v : t) v = Vec3f(unit(random), unit(random), unit(random)) * static_cast<float>(scale);
        if (i == 1) t[2] = t[0] + (t[1] - t[0]) * 0.3f;                                 // collinear, to rounding
        if (i == 2) t[1] = t[2] = t[0];                                                 // a point
        if (i == 3) t[2] = t[1] + Vec3f(1e-6f, 0, 0) * static_cast<float>(scale);       // a sliver
        if (i == 4) t[0].z() = t[1].z() = t[2].z() = 0;                                 // level
        if (i == 5) t[0].x() = t[1].x() = t[2].x() = static_cast<float>(0.25 * scale);  // upright
        if (i == 6) t[1] = t[0] + (t[1] - t[0]) * 1e-4f;                                // narrow
        triangles.push_back(t);
      }
      const Scene scene = scene_of(triangles);
      const VoxelGrid grid = VoxelGrid::around(triangle_bounds_m(scene), 24);
      const BitVolume volume = voxelise(scene, grid);
      for_each_surface_point(scene, 40, [&](const Vec3& p) {
        const Vec3 at = grid.grid_from_scene(p);
        bool found = false;  // a point within rounding of a face may lie on either side
        for (int k = 0; k < 8 && !found; ++k)
          found = volume.test(
              (at + 1e-5 * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)).array().floor().cast<int>());
        ASSERT_TRUE(found) << "scale " << scale << ", round " << round << ", at " << at.transpose();
      });
    }
  }
}

TEST(Voxelise, SetsLittleMoreThanTheTouchedVoxels) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::size_t set = 0, near = 0;
  for (int round = 0; round < 50; ++round) {
    std::array<Vec3f, 3> t;
    for (Vec3f& v : t) v = Vec3f(unit(random), unit(random), unit(random));
    const Scene scene = scene_of({t});
    const VoxelGrid grid = VoxelGrid::around(triangle_bounds_m(scene), 32);
    const BitVolume volume = voxelise(scene, grid);
    BitVolume touched(grid.size);
    for_each_surface_point(scene, 400, [&](const Vec3& p) { touched.set(grid.nearest_voxel(p)); });
    set += volume.count();
    near += volume.intersected(touched.dilated()).count();
    EXPECT_LT(volume.count(), 2 * touched.count());
  }
  EXPECT_LT(set - near, set / 1000);  // except at tips of narrow triangles
}

TEST(Voxelise, AWallHasNoHoles) {
  // A tilted wall of many triangles through the whole box; the rays cross it far from its rim.
  std::vector<std::array<Vec3f, 3>> triangles;
  const auto at = [](int i, int j) {
    const float x = static_cast<float>(i) / 10 - 1, y = static_cast<float>(j) / 10 - 1;
    return Vec3f(x, y, 0.4f * x - 0.7f * y + 0.05f * std::sin(9 * x));
  };
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      triangles.push_back({at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)});
    }
  const Scene scene = scene_of(triangles);
  const VoxelGrid grid = VoxelGrid::around(triangle_bounds_m(scene), 96);
  const BitVolume volume = voxelise(scene, grid);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 through(0.8 * unit(random), 0.8 * unit(random), 0);
    const Vec3 low = through + Vec3(0.1 * unit(random), 0.1 * unit(random), -1.4);
    const Vec3 high = through + Vec3(0.1 * unit(random), 0.1 * unit(random), 1.4);
    EXPECT_TRUE(first_voxel_by_walk(volume, grid.grid_from_scene(low), grid.grid_from_scene(high)));
  }
}

TEST(Voxelise, AnEmptySceneHasNoVoxels) {
  const Scene scene;
  const VoxelGrid grid = VoxelGrid::around(triangle_bounds_m(scene), 128);
  EXPECT_EQ(grid.count(), 0u);
  EXPECT_EQ(voxelise(scene, grid).count(), 0u);
  EXPECT_EQ(voxelise(scene, grid).reduced(4).dilated().count(), 0u);
}

TEST(VoxelGrid, ContainsItsBoxWithAMarginOfAVoxelWithinItsSize) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const double scale = std::pow(10, 12 * unit(random) - 6);
    Eigen::AlignedBox3d box_m(Vec3(unit(random), unit(random), unit(random)) * scale);
    if (i % 5 != 0) box_m.extend(Vec3(unit(random), unit(random), i % 3 ? unit(random) : 0.5) * scale);
    const int longest = 4 + static_cast<int>(200 * unit(random));
    const VoxelGrid grid = VoxelGrid::around(box_m, longest);
    EXPECT_LE(grid.size.maxCoeff(), longest);
    for (const Vec3& corner : {box_m.min(), box_m.max()}) {
      const Vec3 at = grid.grid_from_scene(corner);
      EXPECT_GE(at.minCoeff(), 1);
      EXPECT_LE((at - grid.size.cast<double>()).maxCoeff(), -1 + 1e-6) << i;
    }
    const Eigen::Vector3i v = grid.nearest_voxel(box_m.center());
    EXPECT_TRUE(grid.contains(v));
    EXPECT_LE((grid.centre_m(v) - box_m.center()).cwiseAbs().maxCoeff(), 0.5001 * grid.voxel_m);
  }
}

}  // namespace
}  // namespace luxrig
