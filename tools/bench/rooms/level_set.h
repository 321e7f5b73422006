#pragma once
/// Solids defined by a function instead of faces: vaults, caves, figures.

#include <array>
#include <functional>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct ClosedMesh {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< outward: towards positive values
};

/// The surface where distance_m is 0, by surface nets (S. Gibson 1998) on a grid of cell_m that fills the box: one
/// vertex per cell that the surface passes through. Always closed: a solid that reaches the box's faces is cut off
/// within one cell of them. A plane comes out flat; creases are cut by at most a cell.
///
/// distance_m   negative inside; need not be a true distance, but must change by at most its argument near the surface
[[nodiscard]] ClosedMesh mesh_level_set(const Eigen::AlignedBox3d& box_m, double cell_m,
                                        const std::function<double(const Vec3&)>& distance_m);

/// Distance [m] from a segment.
[[nodiscard]] double distance_to_segment_m(const Vec3& point_m, const Vec3& a_m, const Vec3& b_m);

/// The smaller of two distances, rounded off over about blend_m where they are equal.
[[nodiscard]] double blended_least_m(double a_m, double b_m, double blend_m);

}  // namespace luxrig
