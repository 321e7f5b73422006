#pragma once
/// The region of air that a point is in, as far as closed surfaces decide it.
///
/// Triangles that share an edge belong to one piece of surface. A piece is closed if each of its edges has an even
/// number of triangles. A straight line crosses a closed piece an even number of times or changes sides (Jordan), so
/// parity shows whether a point is inside it. Light from one point to another crosses no surface, so points inside
/// different closed pieces exchange none, by any number of reflections. That decides solids, the inside of walls, the
/// outdoors of a modelled shell, and sealed rooms. It needs no outward normals; open pieces (sheets, scans with holes)
/// are ignored.

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

class AirRegions {
 public:
  explicit AirRegions(const Scene& scene);

  /// Equal for points inside the same closed pieces; 0 outside all. Different sets of pieces give different marks,
  /// except with probability 2⁻⁶⁴.
  [[nodiscard]] std::uint64_t mark(const Vec3& point_world_m) const;

  [[nodiscard]] std::size_t closed_pieces() const { return closed_pieces_; }

 private:
  struct Edge {
    double ax, ay, bx, by;  ///< ends in the same order for all triangles that share it
  };
  struct Triangle {
    Edge edges[3];
    double z_m, dz_dx, dz_dy;  ///< its plane: z_m + dz_dx x + dz_dy y
    std::uint64_t key;         ///< of its piece
  };
  [[nodiscard]] static bool over(const Triangle& triangle, double x, double y);
  [[nodiscard]] std::size_t column(double at, int axis) const;

  Vec3 origin_world_m_;
  Eigen::AlignedBox3d bounds_m_;  ///< of the closed pieces
  std::size_t closed_pieces_ = 0;
  std::size_t per_side_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> begin_;  ///< of each column of the x-y grid, in listed_
  std::vector<std::uint32_t> listed_;
};

/// The regions of air from which a receiver can get light.
class ReceiversAir {
 public:
  ReceiversAir(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers);

  /// False when a closed surface separates the point from every receiver. A point within rounding of a surface counts
  /// as being on both sides.
  [[nodiscard]] bool reaches(const Vec3& point_world_m) const;

 private:
  const RayScene& rays_;
  AirRegions regions_;
  std::vector<std::uint64_t> marks_;  ///< sorted
};

}  // namespace luxrig
