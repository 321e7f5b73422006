#pragma once
/// Illuminance from an unobstructed luminaire with size, by quadrature.

#include "core/transport/evaluator.h"

namespace luxrig {

struct ShapeLight {
  double lux = 0;               ///< ≥ 0, finite
  double error_lx = 0;          ///< estimated bound of the error
  std::size_t evaluations = 0;  ///< of the intensity
};

struct ShapeLightOptions {
  double wanted_relative_error = 1e-5;
  std::size_t max_evaluations = 20'000;  ///< stops there and reports the error reached
};

/// Illuminance [lx at level 1] at a surface point from an unobstructed emitter (not a sky), with the luminance that
/// luminous_shape.h defines:
///   E = ∫ I(-ω) / A(-ω) cosθ dω   over the directions ω in which the shape is seen above the receiver's horizon.
/// The integration variables make horizon, outline and the edge of a narrow beam limits rather than kinks. So it
/// converges fast for any smooth distribution, and steadily for an interpolated one.
///
/// A point, or a shape so small that it looks like one (its angle times 100 is below the wanted error: no distribution
/// changes by its own size within 0.01 rad), gets the photometric distance law. A receiver in or on the shape, or in
/// its plane, gets 0.
/// normal_world   unit
[[nodiscard]] ShapeLight shape_light(const Vec3& position_world_m, const Vec3& normal_world, const Emitter& emitter,
                                     const ShapeLightOptions& options = {});

/// The same, lux only.
[[nodiscard]] double illuminance_lx(const Vec3& position_world_m, const Vec3& normal_world, const Emitter& emitter,
                                    double wanted_relative_error = 1e-6);

/// Radius [m] of the sphere around the lamp's origin that encloses the shape; 0 for a point.
[[nodiscard]] double bounding_radius_m(const LuminousShape& shape);

}  // namespace luxrig
