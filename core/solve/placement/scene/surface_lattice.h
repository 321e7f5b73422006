#pragma once
/// Points of one square lattice laid over surfaces, whatever their triangulation.

#include <array>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Largest of the triangle's projections along x, y and z [m²]; at least 1/√3 of its area.
[[nodiscard]] double widest_shadow_m2(const std::array<Vec3, 3>& triangle_m);

/// Where lines along the axis of that projection, in one world grid of spacing_m, meet the triangle: about
/// widest_shadow_m2 / spacing_m² points. Triangles side by side in a plane continue one lattice, with no point twice on
/// a shared edge. spacing_m > 0; empty for a triangle without area.
[[nodiscard]] std::vector<Vec3> lattice_on(const std::array<Vec3, 3>& triangle_m, double spacing_m);

}  // namespace luxrig
