#pragma once
/// Visibility tests for a whole shape at once.

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace luxrig {

/// A convex region: the inside of all planes. In frame world.
struct Shaft {
  struct Plane {
    Vec3 inwards;       ///< unit
    double distance_m;  ///< inside: inwards · p ≥ distance_m
  };
  std::vector<Plane> planes;
  std::vector<Vec3> corners_world_m;  ///< points whose convex hull contains the region

  [[nodiscard]] Eigen::AlignedBox3d bounds_world_m() const {
    Eigen::AlignedBox3d bounds;
    for (const Vec3& corner : corners_world_m) bounds.extend(corner);
    return bounds;
  }
};

/// From a point to a convex quadrilateral (corners in order), above the plane through the point with `normal_world`.
[[nodiscard]] Shaft shaft_to_quad(const Vec3& from_world_m, const Vec3& normal_world,
                                  std::span<const Vec3, 4> corners_world_m);

/// From a point to the convex hull of any points, by a pyramid around it, above the same plane. Has no planes and
/// corners if the hull is not wholly on one side of the point.
[[nodiscard]] Shaft shaft_to_hull(const Vec3& from_world_m, const Vec3& normal_world,
                                  std::span<const Vec3> corners_world_m);

/// True if the convex hull of `corners` is behind one triangle as seen from a point, or behind two that share the edge
/// between their vertices 0 and 1. of_corner: the triangle that each corner is behind, known to the caller from rays.
/// This function proves that no way between two corners leads past the shared edge.
[[nodiscard]] bool hull_lies_behind(const Vec3& from_m, std::span<const Vec3> corners_m,
                                    std::span<const std::array<Vec3, 3>> triangles_m,
                                    std::span<const std::size_t> of_corner);

/// A tree of boxes around triangles.
class TriangleTree {
 public:
  TriangleTree() = default;
  /// Keeps views of both; coordinates are relative to origin_world_m.
  TriangleTree(std::span<const Vec3f> vertices_m, std::span<const std::array<std::uint32_t, 3>> triangles,
               const Vec3& origin_world_m);

  /// True only if no triangle reaches into the shaft by more than `within_m`. Proven by a plane that separates the
  /// triangle from the shaft. False proves nothing.
  [[nodiscard]] bool keeps_out_of(const Shaft& shaft, double within_m) const;

 private:
  struct Node {
    Vec3f low_m, high_m;
    std::uint32_t begin = 0, end = 0;  ///< into order_; right == 0 = leaf
    std::uint32_t right = 0;           ///< the left child follows its parent
  };
  void build(std::uint32_t begin, std::uint32_t end);

  std::span<const Vec3f> vertices_m_;
  std::span<const std::array<std::uint32_t, 3>> triangles_;
  Vec3 origin_world_m_ = Vec3::Zero();
  std::vector<std::uint32_t> order_;
  std::vector<Vec3f> middles_m_;  ///< only while building
  std::vector<Node> nodes_;
};

}  // namespace luxrig
