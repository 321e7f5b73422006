#pragma once
/// A grid of equal cubes around a scene.
///
/// Frame `grid`: the scene's own (relative to Scene::origin_world_m) shifted by low_m and divided by voxel_m, so that
/// voxel (x, y, z) fills [x, x+1) × [y, y+1) × [z, z+1).

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry.h"

namespace luxrig {

struct VoxelGrid {
  Vec3 low_m = Vec3::Zero();
  double voxel_m = 1;  ///< edge of a voxel
  Eigen::Vector3i size = Eigen::Vector3i::Zero();

  /// A grid of at most `longest` voxels along the longest side of `box_m`, with a margin of one voxel all around, so
  /// that dilation by a voxel stays inside. An empty box gives a grid without voxels; a box without extent gives voxels
  /// of 1 m. requires longest ≥ 4.
  [[nodiscard]] static VoxelGrid around(const Eigen::AlignedBox3d& box_m, int longest) {
    VoxelGrid grid;
    if (box_m.isEmpty()) return grid;
    const Vec3 extent_m = box_m.sizes();
    const double side_m = extent_m.maxCoeff();
    // Slightly larger than the box, so that its far faces lie inside their voxels.
    if (side_m > 0) grid.voxel_m = side_m * (1 + 1e-6) / (longest - 2);
    for (int i = 0; i < 3; ++i)
      grid.size[i] = std::min(longest, static_cast<int>(std::floor(extent_m[i] / grid.voxel_m)) + 3);
    grid.low_m = box_m.min() - Vec3::Constant(grid.voxel_m * (1 + 1e-7));
    return grid;
  }

  /// The grid with cells of factor³ of these voxels each; the last cells may reach beyond them.
  [[nodiscard]] VoxelGrid coarser(int factor) const {
    VoxelGrid grid = *this;
    grid.voxel_m = voxel_m * factor;
    grid.size = (size.array() + (factor - 1)) / factor;
    return grid;
  }

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(size.z());
  }
  [[nodiscard]] bool contains(const Eigen::Vector3i& voxel) const {
    return (voxel.array() >= 0).all() && (voxel.array() < size.array()).all();
  }
  /// Index of a voxel in arrays: x fastest.
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& voxel) const {
    return (static_cast<std::size_t>(voxel.z()) * static_cast<std::size_t>(size.y()) +
            static_cast<std::size_t>(voxel.y())) *
               static_cast<std::size_t>(size.x()) +
           static_cast<std::size_t>(voxel.x());
  }
  [[nodiscard]] Vec3 grid_from_scene(const Vec3& point_m) const { return (point_m - low_m) / voxel_m; }
  [[nodiscard]] Vec3 scene_from_grid(const Vec3& point_grid) const { return low_m + voxel_m * point_grid; }
  [[nodiscard]] Vec3 centre_m(const Eigen::Vector3i& voxel) const {
    return scene_from_grid(voxel.cast<double>() + Vec3::Constant(0.5));
  }
  /// The voxel that holds a point; the nearest one if the point is outside. requires count() > 0.
  [[nodiscard]] Eigen::Vector3i nearest_voxel(const Vec3& point_m) const {
    const Vec3 at = grid_from_scene(point_m);
    Eigen::Vector3i voxel;
    for (int i = 0; i < 3; ++i)
      voxel[i] = static_cast<int>(std::clamp(std::floor(at[i]), 0.0, static_cast<double>(size[i] - 1)));
    return voxel;
  }
};

}  // namespace luxrig
