#pragma once
/// Real spherical harmonics of the first three orders (bands 0, 1, 2), orthonormal over the sphere.
///
/// Coefficients are ordered (l, m) = (0,0), (1,-1), (1,0), (1,1), (2,-2) … (2,2). A function of order n has its first
/// n² coefficients.
/// source   R. Ramamoorthi, P. Hanrahan, "An Efficient Representation for Irradiance Environment Maps", 2001

#include "core/geometry.h"

namespace luxrig {

inline constexpr int kMaxCoefficients = 9;
using Harmonics = Eigen::Matrix<double, kMaxCoefficients, 1>;

[[nodiscard]] constexpr int coefficients_of_order(int order) { return order * order; }

/// Y_lm(direction) for all nine; direction is unit.
[[nodiscard]] Harmonics harmonics(const Vec3& direction);

/// Coefficients of the lobe max(0, cosθ) around a unit axis, exact for each band (π, 2π/3, π/4 times Y). Its dot
/// product with the coefficients of the incoming radiance [cd/m²] is the illuminance [lx] of a plane with that normal,
/// within three orders: they hold 99.2 % of the energy of the exact lobe.
[[nodiscard]] Harmonics cosine_lobe(const Vec3& axis);

}  // namespace luxrig
