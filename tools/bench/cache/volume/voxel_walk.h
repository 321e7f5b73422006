#pragma once
/// Rays through voxels in three ways: visiting each voxel (3-D DDA), skipping by a distance field, and the thesis's
/// sparse march, which samples few places and may miss voxels between them.

#include <limits>
#include <optional>
#include <span>

#include "tools/bench/cache/volume/bit_volume.h"
#include "tools/bench/cache/volume/distance_field.h"

namespace luxrig {

/// The voxels that a segment passes through, in order, none left out (J. Amanatides, A. Woo, "A Fast Voxel Traversal
/// Algorithm for Ray Tracing", Eurographics 1987). Parameters t run from 0 at `from` to 1 at `to`.
class VoxelWalk {
 public:
  /// Points in frame grid (voxel units), finite. Skips the part of the segment outside the grid.
  VoxelWalk(const Eigen::Vector3i& size, const Vec3& from_grid, const Vec3& to_grid);

  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] const Eigen::Vector3i& voxel() const { return voxel_; }
  [[nodiscard]] double entered_at() const { return entered_; }  ///< t at which the voxel was entered
  void next() {
    const int axis = exit_[0] < exit_[1] ? (exit_[0] < exit_[2] ? 0 : 2) : (exit_[1] < exit_[2] ? 1 : 2);
    entered_ = exit_[axis];
    voxel_[axis] += step_[axis];
    exit_[axis] += per_voxel_[axis];
    done_ = entered_ > end_ || voxel_[axis] < 0 || voxel_[axis] >= size_[axis];
  }
  /// Goes on to the voxel at t, at or after the current one.
  void skip_to(double t);

 private:
  void place_at(double t);

  Eigen::Vector3i size_, voxel_, step_;
  Vec3 from_, way_, per_voxel_, exit_;
  double entered_ = 0, end_ = 1;
  bool done_ = false;
};

struct VoxelHit {
  Eigen::Vector3i voxel;
  double t;  ///< place along the segment, 0…1
};

/// The first set voxel on the segment; exact for the voxels.
[[nodiscard]] std::optional<VoxelHit> first_voxel_by_walk(const BitVolume& volume, const Vec3& from_grid,
                                                          const Vec3& to_grid);

/// The same answer; crosses empty space in strides (thesis §3.1.6).
[[nodiscard]] std::optional<VoxelHit> first_voxel_by_distance(const DistanceField& field, const Vec3& from_grid,
                                                              const Vec3& to_grid);

/// Sparse stratified march of the thesis (§3.2.4): one sample in each of `steps` equal parts of the segment, at the
/// share `jitter` (0…1) of the part. May miss voxels.
[[nodiscard]] std::optional<VoxelHit> first_voxel_by_march(const BitVolume& volume, const Vec3& from_grid,
                                                           const Vec3& to_grid, int steps, double jitter);

}  // namespace luxrig
