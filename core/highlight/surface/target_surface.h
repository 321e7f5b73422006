#pragma once
/// A scanned or modelled object as a surface: welded vertices, normals, areas, neighbours.

#include <limits>
#include <span>
#include <vector>

#include "core/result.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Points of a surface and the triangles between them. Mesh vertices at the same place, to 3e-7 of its largest
/// coordinate, are one point (a texture's seam does not divide the surface), numbered by first use. Triangles without
/// area are left out. The mesh may be open, non-manifold or a soup. Its outside is where its triangles run
/// anticlockwise.
struct TargetSurface {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  Vec3 origin_world_m = Vec3::Zero();
  std::vector<Vec3> points_m;                           ///< relative to origin_world_m
  std::vector<Vec3> normals;                            ///< unit, outwards: mean by angle; zero where triangles cancel
  std::vector<double> areas_m2;                         ///< a third of each triangle around the point
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into points_m; each has area
  std::vector<std::uint32_t> point_of_vertex;           ///< per vertex of the scene; kNone = no triangle uses it

  /// Points that share an edge with this one (in even_surface.h: that lie around it), each once, rising.
  [[nodiscard]] std::span<const std::uint32_t> ring(std::uint32_t point) const {
    return std::span(rings_).subspan(ring_begin_[point], ring_begin_[point + 1] - ring_begin_[point]);
  }
  [[nodiscard]] Vec3 point_world_m(std::uint32_t point) const { return origin_world_m + points_m[point]; }
  [[nodiscard]] double area_m2() const;         ///< of all triangles
  [[nodiscard]] Vec3 centroid_world_m() const;  ///< of the area; the origin if there is none
  [[nodiscard]] double diagonal_m() const;      ///< of the bounding box; 0 without points
  /// √(12 · mean squared distance from the centroid): the diagonal of an even rectangle or box. Unlike the diagonal of
  /// the bounding box, it does not change with rotation. 0 without triangles.
  [[nodiscard]] double size_m() const;
  [[nodiscard]] double median_edge_m() const;  ///< 0 without triangles

  std::vector<std::uint32_t> ring_begin_ = {0};  ///< data of ring()
  std::vector<std::uint32_t> rings_;
};

/// A mesh without triangles gives a surface without points. Refuses coordinates that are not finite, and indices out of
/// range.
[[nodiscard]] Result<TargetSurface> make_target_surface(const Scene& target);

}  // namespace luxrig
