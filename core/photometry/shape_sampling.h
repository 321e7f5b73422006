#pragma once
/// Geometry of luminous shapes, in frame lamp: what Monte-Carlo and quadrature need of them.

#include "core/photometry/intensity.h"
#include "core/photometry/luminous_shape.h"

namespace luxrig {

/// A(ω) [m²]: area of the shape as seen from the direction ω (unit) in which light leaves. 0 for a point.
[[nodiscard]] double projected_area_m2(const LuminousShape& shape, const Vec3& direction_lamp);

struct ShapeSample {
  Vec3 direction = Vec3::UnitZ();  ///< unit, from the point that asks towards the shape
  double distance_m = 0;           ///< to the place on the shape (the nearer one along the direction)
  double density_per_sr = 0;       ///< 0: no place of the shape can be seen from there
};

/// A place on the shape as seen from a point, drawn over the solid angle that the shape fills there: evenly for sphere
/// and rectangle, evenly to a third for a disk and roughly for a cylinder, always with the density that is stated. A
/// point that lies in the shape, on it or in its plane gets density 0. Continuous in (u, v), so that strata survive (a
/// cylinder's wall and its end are two pieces). Not for Kind::point.
[[nodiscard]] ShapeSample sample_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m, double u, double v);

/// Density with which sample_seen_from() draws a direction; 0 when the direction misses the shape.
[[nodiscard]] double density_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m,
                                       const Vec3& direction_lamp);

/// Way to the nearer place of the shape along a direction that density_seen_from() has above 0.
[[nodiscard]] double distance_towards_m(const LuminousShape& shape, const Vec3& point_lamp_m,
                                        const Vec3& direction_lamp);

/// Place from which light leaves in a given direction, drawn evenly over the shape's projected area (density
/// 1 / projected_area_m2 per m² perpendicular to the direction). The origin for a point.
[[nodiscard]] Vec3 sample_leaving_place_m(const LuminousShape& shape, const Vec3& direction_lamp, double u, double v);

}  // namespace luxrig
