#pragma once
/// Luminous intensity distributions: how a luminaire's light leaves it, by direction.
///
/// Frame `lamp`: origin in the photometric centre. The nadir of the data (gamma = 0; type C vertical
/// angle 0) is -Z. C plane 0 (IES horizontal angle 0) contains +X; C turns counter-clockwise seen from
/// above (from +Z), so C = 90° contains +Y.

#include <memory>

#include "core/geometry.h"

namespace luxrig {

class IntensityDistribution {
 public:
  virtual ~IntensityDistribution() = default;

  /// Luminous intensity [cd] at rated flux, in the direction in which light leaves.
  /// direction_lamp   unit vector in frame lamp
  /// returns          ≥ 0, finite
  [[nodiscard]] virtual double intensity_cd(const Vec3& direction_lamp) const = 0;

  /// Total luminous flux [lm]: the integral of the intensity over all directions.
  [[nodiscard]] virtual double flux_lm() const = 0;

  /// Largest intensity [cd] over all directions.
  [[nodiscard]] virtual double max_intensity_cd() const = 0;

  /// Full angle [rad] of the cone about -Z outside which nothing is emitted (2π when it emits upwards
  /// too). Lets a caller skip receivers that can get nothing.
  [[nodiscard]] virtual double emission_cone_rad() const = 0;
};

using Intensity = std::shared_ptr<const IntensityDistribution>;  // one file serves many fixtures

/// The same in all directions: flux / 4π.
[[nodiscard]] Intensity make_isotropic(double flux_lm);

/// A spot about -Z: I(γ) = I0 · cos^n(γ scaled so that) half of I0 is reached at half the beam angle and
/// a tenth at half the field angle; nothing beyond the horizon of its fall-off. See intensity.cpp for the
/// profile. requires 0 < beam_angle < field_angle < π.
[[nodiscard]] Intensity make_spot(double flux_lm, double beam_angle_rad, double field_angle_rad);

/// `of`, scaled so that its flux is flux_lm (> 0).
[[nodiscard]] Intensity scaled_to_flux(Intensity of, double flux_lm);

}  // namespace luxrig
