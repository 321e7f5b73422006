#pragma once
/// Geometry of luminous shapes, in frame lamp, for Monte Carlo and quadrature.

#include "core/photometry/intensity.h"
#include "core/photometry/shapes/luminous_shape.h"

namespace luxrig {

/// A(ω) [m²]: area of the shape seen from the unit direction ω of emission. 0 for a point.
[[nodiscard]] double projected_area_m2(const LuminousShape& shape, const Vec3& direction_lamp);

struct ShapeSample {
  Vec3 direction = Vec3::UnitZ();  ///< unit, from the observing point towards the shape
  double distance_m = 0;           ///< to the place on the shape (the nearer one along the direction)
  double density_per_sr = 0;       ///< 0 = no part of the shape is visible from there
};

/// Samples a place on the shape as seen from a point, over the solid angle that the shape fills there: uniform for
/// sphere and rectangle, uniform to a third for a disk, roughly for a cylinder; the stated density is always exact. A
/// point in the shape, on it or in its plane gets density 0. Continuous in (u, v), so that strata survive (a cylinder's
/// wall and its end are two pieces). Not for Kind::point.
[[nodiscard]] ShapeSample sample_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m, double u, double v);

/// Density of sample_seen_from() for a direction; 0 if the direction misses the shape.
[[nodiscard]] double density_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m,
                                       const Vec3& direction_lamp);

/// Distance to the nearer place of the shape along a direction whose density_seen_from() is above 0.
[[nodiscard]] double distance_towards_m(const LuminousShape& shape, const Vec3& point_lamp_m,
                                        const Vec3& direction_lamp);

/// Place from which light is emitted in a given direction, sampled uniformly over the shape's projected area (density 1
/// / projected_area_m2 per m² perpendicular to the direction). The origin for a point.
[[nodiscard]] Vec3 sample_leaving_place_m(const LuminousShape& shape, const Vec3& direction_lamp, double u, double v);

}  // namespace luxrig
