#pragma once
/// Width of a distribution: from its intensity in two planes, and from the cone that holds its flux.

#include "core/photometry/intensity.h"

namespace luxrig {

/// Full angles [rad, 0…2π] in the planes C0–C180 and C90–C270.
struct PlaneAngles {
  double c0_rad = 0, c90_rad = 0;
};

/// In each plane: from its brightest direction to both sides, as far as the intensity is at least `share` of the
/// distribution's maximum. Returns the angle between the two ends; 0 if the plane does not reach that intensity.
/// share      0 < share ≤ 1
/// accuracy   1e-9 of the ends; dips narrower than 1/7200 of the emission cone are missed
[[nodiscard]] PlaneAngles angles_to_share(const IntensityDistribution& of, double share);

/// Beam angle: to half of the maximum.
[[nodiscard]] inline PlaneAngles beam_angles(const IntensityDistribution& of) { return angles_to_share(of, 0.5); }
/// Field angle: to a tenth of the maximum.
[[nodiscard]] inline PlaneAngles field_angles(const IntensityDistribution& of) { return angles_to_share(of, 0.1); }

/// Full angle [rad, 0…2π] of the cone about -Z that holds a share of the flux (thesis §6.5 takes 90 % of an IES file's
/// flux as its beam).
/// share      0 < share ≤ 1
/// accuracy   1e-4 rad (by quadrature, 1440 rings of 96 directions)
[[nodiscard]] double cone_of_flux_rad(const IntensityDistribution& of, double share);

}  // namespace luxrig
