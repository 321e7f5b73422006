#pragma once
/// Which air a point is in, so far as closed surfaces decide it.
///
/// Triangles that share an edge belong to one piece of surface; a piece each of whose edges has an even number of
/// triangles is closed. A straight line crosses a closed piece an even number of times or changes sides (Jordan), so
/// parity says of each closed piece whether a point is inside. Light that gets from one point to another crosses no
/// surface: two points that differ in what closed pieces they are inside of exchange none, by any number of
/// reflections. That settles solids, the inside of walls, the outdoors of a modelled shell, and sealed rooms; it needs
/// no outward normals, and open pieces (sheets, scans with holes) are not judged at all.

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

class AirRegions {
 public:
  explicit AirRegions(const Scene& scene);

  /// Equal for points inside of the same closed pieces; 0 inside of none. Different pieces give different marks but
  /// for a chance of 2⁻⁶⁴.
  [[nodiscard]] std::uint64_t mark(const Vec3& point_world_m) const;

  [[nodiscard]] std::size_t closed_pieces() const { return closed_pieces_; }

 private:
  struct Edge {
    double ax, ay, bx, by;  ///< the same order of ends in all triangles that share it
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
  std::vector<std::uint32_t> begin_;  ///< of each column of the grid over x and y, in listed_
  std::vector<std::uint32_t> listed_;
};

/// Air from which a receiver can get light.
class ReceiversAir {
 public:
  ReceiversAir(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers);

  /// False when a closed surface stands between the point and every receiver. A point within rounding of a surface
  /// counts as on both sides of it.
  [[nodiscard]] bool reaches(const Vec3& point_world_m) const;

 private:
  const RayScene& rays_;
  AirRegions regions_;
  std::vector<std::uint64_t> marks_;  ///< sorted
};

}  // namespace luxrig
