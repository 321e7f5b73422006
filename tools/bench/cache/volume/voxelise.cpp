#include "tools/bench/cache/volume/voxelise.h"

#include <array>

#include "tools/bench/cache/volume/voxel_walk.h"

namespace luxrig {
namespace {

/// Points within this distance of a voxel's face [voxels] count as in both voxels: far more than rounding, far less
/// than a voxel.
constexpr double kSlack = 1e-6;
/// Triangles whose height is less than this share of their longest edge are voxelised as that edge.
constexpr double kSliver = 1e-8;

using Corners = std::array<Vec3, 3>;

class Rasteriser {
 public:
  explicit Rasteriser(BitVolume& volume) : volume_(volume) {}

  void add(const Corners& corners) {
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    int longest = 0;
    double length = -1;
    for (int i = 0; i < 3; ++i) {
      const double l = (corners[(i + 1) % 3] - corners[i]).norm();
      if (l > length) {
        longest = i;
        length = l;
      }
    }
    if (normal.norm() <= kSliver * length * length)
      add_segment(corners[longest], corners[(longest + 1) % 3]);
    else
      add_along_dominant_axis(corners, normal);
  }

 private:
  int lowest(double coordinate, int axis) const {
    return std::clamp(static_cast<int>(std::floor(coordinate - kSlack)), 0, volume_.size()[axis] - 1);
  }
  int highest(double coordinate, int axis) const {
    return std::clamp(static_cast<int>(std::floor(coordinate + kSlack)), 0, volume_.size()[axis] - 1);
  }

  void add_segment(const Vec3& from, const Vec3& to) {
    for (VoxelWalk walk(volume_.size(), from, to); !walk.done(); walk.next()) volume_.set(walk.voxel());
    for (const Vec3& end : {from, to})
      for (int x = lowest(end.x(), 0); x <= highest(end.x(), 0); ++x)
        for (int y = lowest(end.y(), 1); y <= highest(end.y(), 1); ++y)
          for (int z = lowest(end.z(), 2); z <= highest(end.z(), 2); ++z) volume_.set(x, y, z);
  }

  void add_along_dominant_axis(const Corners& corners, const Vec3& normal) {
    int depth = 0;
    normal.cwiseAbs().maxCoeff(&depth);
    const int a = (depth + 1) % 3, b = (depth + 2) % 3;
    Vec3 low = corners[0], high = corners[0];
    for (const Vec3& c : corners) {
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    // Edge functions n·p + d, positive inside, at the corner of a square that is farthest inside.
    struct Edge {
      double na, nb, at_origin;
    };
    std::array<Edge, 3> edges;
    const double turn = normal[depth] > 0 ? 1 : -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = corners[i];
      const Vec3 along = turn * (corners[(i + 1) % 3] - p);
      const double na = -along[b], nb = along[a];
      edges[i] = {
          na, nb,
          -(na * p[a] + nb * p[b]) + std::max(na, 0.0) + std::max(nb, 0.0) + kSlack * (std::abs(na) + std::abs(nb))};
    }
    const double slope_a = -normal[a] / normal[depth], slope_b = -normal[b] / normal[depth];
    const double half = 0.5 * (std::abs(slope_a) + std::abs(slope_b));
    Eigen::Vector3i voxel;
    for (int j = lowest(low[b], b); j <= highest(high[b], b); ++j)
      for (int i = lowest(low[a], a); i <= highest(high[a], a); ++i) {
        bool outside = false;
        for (const Edge& edge : edges) outside = outside || edge.at_origin + edge.na * i + edge.nb * j < 0;
        if (outside) continue;
        const double middle =
            corners[0][depth] + slope_a * (i + 0.5 - corners[0][a]) + slope_b * (j + 0.5 - corners[0][b]);
        const int from = lowest(std::clamp(middle - half, low[depth], high[depth]), depth);
        const int to = highest(std::clamp(middle + half, low[depth], high[depth]), depth);
        voxel[a] = i;
        voxel[b] = j;
        for (voxel[depth] = from; voxel[depth] <= to; ++voxel[depth]) volume_.set(voxel);
      }
  }

  BitVolume& volume_;
};

}  // namespace

Eigen::AlignedBox3d triangle_bounds_m(const Scene& scene) {
  Eigen::AlignedBox3d box_m;
  for (const auto& triangle : scene.triangles)
    for (const std::uint32_t vertex : triangle) box_m.extend(scene.vertices_m[vertex].cast<double>());
  return box_m;
}

BitVolume voxelise(const Scene& scene, const VoxelGrid& grid) {
  BitVolume volume(grid.size);
  if (grid.count() == 0) return volume;
  Rasteriser rasteriser(volume);
  for (const auto& triangle : scene.triangles) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = grid.grid_from_scene(scene.vertices_m[triangle[i]].cast<double>());
    rasteriser.add(corners);
  }
  return volume;
}

}  // namespace luxrig
