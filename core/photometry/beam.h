#pragma once
/// How wide a distribution is: by its intensity in two planes, and by the cone that holds its flux.

#include "core/photometry/intensity.h"

namespace luxrig {

/// Full angles [rad, 0…2π] in the planes C0–C180 and C90–C270.
struct PlaneAngles {
  double c0_rad = 0, c90_rad = 0;
};

/// In each plane, from its brightest direction to both sides as far as the intensity stays at least `share` of the
/// distribution's maximum; the angle between the two ends. 0 where the plane does not reach that at all.
/// share      0 < share ≤ 1
/// accuracy   1e-9 of the ends; dips narrower than 1/7200 of the emission cone are not seen
[[nodiscard]] PlaneAngles angles_to_share(const IntensityDistribution& of, double share);

/// Beam angle: to half of the maximum.
[[nodiscard]] inline PlaneAngles beam_angles(const IntensityDistribution& of) { return angles_to_share(of, 0.5); }
/// Field angle: to a tenth of the maximum.
[[nodiscard]] inline PlaneAngles field_angles(const IntensityDistribution& of) { return angles_to_share(of, 0.1); }

/// Full angle [rad, 0…2π] of the cone about -Z that holds a share of the flux (thesis §6.5: 90 % of an IES file's is
/// taken as its beam).
/// share      0 < share ≤ 1
/// accuracy   1e-4 rad (by quadrature, 1440 rings of 96 directions)
[[nodiscard]] double cone_of_flux_rad(const IntensityDistribution& of, double share);

}  // namespace luxrig
