#pragma once
/// Daylight: CIE skies, and the sun. Each is scaled to a given illuminance, measured or looked up. Directions are in
/// frame world, +Z up; nothing shines from below the horizon.

#include <array>

#include "core/photometry/sky/sky_luminance.h"

namespace luxrig {

/// Mean apparent diameter of the sun [rad]: 0.533°.
inline constexpr double kSunDiameter_rad = rad_from_deg(0.533);

/// Parameters of ISO 15469 / CIE S 011, table 1: gradation a, b and indicatrix c, d, e.
struct GeneralSkyParameters {
  double a, b, c, d, e;
};
inline constexpr int kGeneralSkyTypes = 15;
/// type   1 (overcast, steep gradation) … 5 (uniform) … 12 (CIE clear, low turbidity) … 15. requires 1 ≤ type ≤ 15
[[nodiscard]] GeneralSkyParameters general_sky_parameters(int type);

/// Uniform luminance E / π. requires horizontal_lx > 0
[[nodiscard]] Sky make_uniform_sky(double horizontal_lx);

/// CIE traditional overcast sky (type 16 of ISO 15469; Moon and Spencer 1942):
///   L(h) = Lz (1 + 2 sin h) / 3,   E = 7π/9 Lz.   requires horizontal_lx > 0
[[nodiscard]] Sky make_overcast_sky(double horizontal_lx);

/// CIE standard general sky. With Z the zenith angle of the direction and χ its angle from the sun,
///   L ~ (1 + a e^(b / cos Z)) · (1 + c (e^(d χ) - e^(d π/2)) + e cos² χ),
/// scaled so that the horizontal illuminance is horizontal_lx (to 1e-6). Without the sun itself.
/// towards_sun_world   unit; above the horizon
/// requires            1 ≤ type ≤ 15, horizontal_lx > 0
[[nodiscard]] Sky make_general_sky(int type, const Vec3& towards_sun_world, double horizontal_lx);

/// CIE standard clear sky, low turbidity: type 12 of the general sky.
[[nodiscard]] Sky make_clear_sky(const Vec3& towards_sun_world, double horizontal_lx);

/// The sun: a disk of 0.533° and uniform luminance, normal_lx on a plane facing it. Only the part above the horizon
/// shines. Horizontal illuminance of a sun wholly above the horizon: normal_lx · sin h.
/// requires   |towards_sun_world| = 1, above the horizon; normal_lx > 0
[[nodiscard]] Sky make_sun(const Vec3& towards_sun_world, double normal_lx);

}  // namespace luxrig
