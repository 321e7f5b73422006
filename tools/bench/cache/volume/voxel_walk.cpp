#include "tools/bench/cache/volume/voxel_walk.h"

namespace luxrig {

VoxelWalk::VoxelWalk(const Eigen::Vector3i& size, const Vec3& from_grid, const Vec3& to_grid)
    : size_(size), voxel_(0, 0, 0), from_(from_grid), way_(to_grid - from_grid) {
  double begin = 0;
  for (int i = 0; i < 3; ++i) {
    step_[i] = way_[i] > 0 ? 1 : -1;
    per_voxel_[i] = way_[i] == 0 ? std::numeric_limits<double>::infinity() : 1 / std::abs(way_[i]);
    exit_[i] = std::numeric_limits<double>::infinity();
    if (way_[i] == 0) {
      if (!(from_[i] >= 0 && from_[i] <= size_[i])) done_ = true;
      continue;
    }
    const double a = -from_[i] / way_[i], b = (size_[i] - from_[i]) / way_[i];
    begin = std::max(begin, std::min(a, b));
    end_ = std::min(end_, std::max(a, b));
  }
  if (size_.minCoeff() <= 0 || !(begin <= end_)) done_ = true;
  if (!done_) place_at(begin);
}

void VoxelWalk::place_at(double t) {
  entered_ = t;
  for (int i = 0; i < 3; ++i) {
    const double at = from_[i] + t * way_[i];
    voxel_[i] = static_cast<int>(std::clamp(std::floor(at), 0.0, static_cast<double>(size_[i] - 1)));
    // A walk towards low coordinates that starts on a voxel's low face leaves it at once.
    if (way_[i] != 0) exit_[i] = (voxel_[i] + (step_[i] > 0 ? 1 : 0) - from_[i]) / way_[i];
  }
}

void VoxelWalk::skip_to(double t) {
  if (t > end_) {
    done_ = true;
    return;
  }
  place_at(t);
}

std::optional<VoxelHit> first_voxel_by_walk(const BitVolume& volume, const Vec3& from_grid, const Vec3& to_grid) {
  for (VoxelWalk walk(volume.size(), from_grid, to_grid); !walk.done(); walk.next())
    if (volume.test(walk.voxel())) return VoxelHit{walk.voxel(), walk.entered_at()};
  return std::nullopt;
}

std::optional<VoxelHit> first_voxel_by_distance(const DistanceField& field, const Vec3& from_grid,
                                                const Vec3& to_grid) {
  // From any point of a voxel at chessboard distance d from the nearest set one, d - 1 voxels along the fastest axis
  // are free. The tiny margin keeps rounding on the safe side.
  const double stride = (1 - 1e-9) / std::max((to_grid - from_grid).cwiseAbs().maxCoeff(), 1e-300);
  for (VoxelWalk walk(field.size(), from_grid, to_grid); !walk.done();) {
    const int distance = field.at(walk.voxel());
    if (distance == 0) return VoxelHit{walk.voxel(), walk.entered_at()};
    if (distance > 2)
      walk.skip_to(walk.entered_at() + (distance - 1) * stride);
    else
      walk.next();
  }
  return std::nullopt;
}

std::optional<VoxelHit> first_voxel_by_march(const BitVolume& volume, const Vec3& from_grid, const Vec3& to_grid,
                                             int steps, double jitter) {
  const Vec3 way = to_grid - from_grid;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + jitter) / steps;
    const Vec3 at = from_grid + t * way;
    if (!((at.array() >= 0).all() && (at.array() < volume.size().cast<double>().array()).all())) continue;
    const Eigen::Vector3i voxel = at.cast<int>();
    if (volume.test(voxel)) return VoxelHit{voxel, t};
  }
  return std::nullopt;
}

}  // namespace luxrig
