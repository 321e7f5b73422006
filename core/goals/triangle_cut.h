#pragma once
/// Cuts a triangle at the boundaries of unit cells. Internal to core/goals.

#include <array>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// The part of a triangle in one cell.
struct CutPiece {
  std::array<std::uint32_t, 3> cell;
  Vec3 centroid;  ///< of the part, in cells
  double area;    ///< in cells²
};

/// Appends the parts of a triangle, in time linear in their number. Their areas add up to the triangle's. A triangle
/// without area has none. A part within a boundary belongs to the cell above.
/// corners   in cells, finite, ≥ 0
void cut_triangle(const std::array<Vec3, 3>& corners, std::vector<CutPiece>& pieces);

/// How many parts a triangle has on average over all offsets of the grid.
[[nodiscard]] double expected_pieces(const std::array<Vec3, 3>& corners);

}  // namespace luxrig
