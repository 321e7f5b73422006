#pragma once
/// Luminous intensity distributions: how a luminaire emits light, by direction.
///
/// Frame `lamp`: origin in the photometric centre. The nadir of the data (gamma = 0; type C vertical angle 0) is -Z. C
/// plane 0 (IES horizontal angle 0) contains +X. C turns counter-clockwise seen from above (from +Z), so C = 90°
/// contains +Y.

#include <memory>

#include "core/geometry.h"

namespace luxrig {

/// A random direction with its probability density [1/sr].
struct DirectionSample {
  Vec3 direction = Vec3::UnitZ();  ///< unit
  double density_per_sr = 0;       ///< 0 = no direction could be sampled
};

class IntensityDistribution {
 public:
  virtual ~IntensityDistribution() = default;

  /// Luminous intensity [cd] at rated flux in a direction of emission.
  /// direction_lamp   unit vector in frame lamp
  /// returns          ≥ 0, finite
  [[nodiscard]] virtual double intensity_cd(const Vec3& direction_lamp) const = 0;

  /// Total luminous flux [lm]: the integral of the intensity over all directions.
  [[nodiscard]] virtual double flux_lm() const = 0;

  /// Largest intensity [cd] over all directions.
  [[nodiscard]] virtual double max_intensity_cd() const = 0;

  /// Full angle [rad] of the cone about -Z outside which nothing is emitted (2π if it also emits upwards). Lets a
  /// caller skip receivers that get no light.
  [[nodiscard]] virtual double emission_cone_rad() const = 0;

  /// Direction in frame lamp for a point of the unit square, sampled with density_per_sr(). Nearby points give nearby
  /// directions, so that strata of the square survive. The base class samples the emission cone uniformly.
  [[nodiscard]] virtual DirectionSample sample(double u, double v) const;

  /// Density [1/sr] of sample() for a direction. Positive wherever the intensity is, and as nearly proportional to it
  /// as is cheap.
  [[nodiscard]] virtual double density_per_sr(const Vec3& direction_lamp) const;
};

using Intensity = std::shared_ptr<const IntensityDistribution>;  // one file serves many fixtures

/// The same in all directions: flux / 4π. requires flux_lm > 0.
[[nodiscard]] Intensity make_isotropic(double flux_lm);

/// I0 cosγ below the horizontal: a plane diffuser facing down. I0 = flux / π. requires flux_lm > 0.
[[nodiscard]] Intensity make_lambertian(double flux_lm);

/// I0 cosⁿγ below the horizontal, I0 = flux (n + 1) / 2π. requires flux_lm > 0 and 0 ≤ exponent ≤ 1e6.
[[nodiscard]] Intensity make_cosine_power(double flux_lm, double exponent);

/// An upright cylinder (axis z) of uniform luminance, including both ends: I = L (d l sinγ + π/4 d² |cosγ|) with
/// L = flux / (π² d (l + d/2)). requires flux_lm, diameter_m and length_m > 0.
[[nodiscard]] Intensity make_lambertian_cylinder(double flux_lm, double diameter_m, double length_m);

/// A spot about -Z with a soft edge. With b = half the beam angle and f = half the field angle,
///   I(γ) = I0 · 2^-(γ/b)^p · w(γ),   p = ln(log2 10) / ln(f/b),
/// so that I(b) is exactly I0/2 and I(f) exactly I0/10. w is 1 up to f and falls to 0 at γ = 2f along the quintic
/// 1 - 6t⁵ + 15t⁴ - 10t³: nothing is emitted beyond the full field angle from the axis. p is 2 (a Gaussian) at f/b =
/// 1.82, larger (a flatter top) for a sharper edge. Beyond f/b = 3.3 the axis has a hot spot. I0 follows from the flux
/// by quadrature to 1e-12.
/// requires flux_lm > 0 and 0 < beam_angle < field_angle < π (asserted; the rig file is checked before).
[[nodiscard]] Intensity make_spot(double flux_lm, double beam_angle_rad, double field_angle_rad);

/// `of`, scaled so that its flux is flux_lm. requires `of` not null, both fluxes > 0 (asserted).
[[nodiscard]] Intensity scaled_to_flux(Intensity of, double flux_lm);

}  // namespace luxrig
