#pragma once
/// Points of one square lattice laid over surfaces, whatever triangles they are cut into.

#include <array>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// The triangle's shadow along the axis (x, y or z) in which it is widest [m²]; at least 1/√3 of its area.
[[nodiscard]] double widest_shadow_m2(const std::array<Vec3, 3>& triangle_m);

/// Where lines along that axis, spacing_m apart through the whole world, meet the triangle: about
/// widest_shadow_m2 / spacing_m² points, which for triangles side by side in a plane continue one lattice, none given
/// twice along a shared edge. spacing_m > 0; none for a triangle without area.
[[nodiscard]] std::vector<Vec3> lattice_on(const std::array<Vec3, 3>& triangle_m, double spacing_m);

}  // namespace luxrig
