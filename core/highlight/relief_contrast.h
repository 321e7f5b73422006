#pragma once
/// How well distant lights bring out interest points: the thesis's two measures (§6.4.3, §6.5.5).

#include <span>
#include <vector>

#include "core/highlight/target_rays.h"
#include "core/highlight/target_surface.h"

namespace luxrig {

struct DistantBeam {
  Vec3 direction;             ///< unit, from the object to the light
  double illuminance_lx = 1;  ///< on a surface at right angles to it
};

struct ReliefContrast {
  /// Shadow transition: of two neighbours (one-ring), one is lit by a beam and the other is not, as it faces away or
  /// the target itself shades it.
  double points_with_transition = 0;  ///< share of the interest points with one to any neighbour, for any beam
  double pairs_with_transition = 0;   ///< share of all pairs (interest point, neighbour)
  double local_contrast_lx = 0;       ///< largest difference in illuminance to a neighbour, mean over interest points
  double lit_points = 0;              ///< share of the interest points that some beam reaches
};

/// interest   indices of points of the surface. Zeros when there are none.
[[nodiscard]] ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target,
                                             std::span<const std::uint32_t> interest,
                                             std::span<const DistantBeam> beams, double lift_m, int threads);

}  // namespace luxrig
