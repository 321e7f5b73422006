#pragma once
/// How well lights bring out interest points: the thesis's measures (§6.4.3, §6.5.5), for distant and for real lights.

#include <span>
#include <vector>

#include "core/highlight/shadow/surroundings.h"
#include "core/highlight/shadow/target_rays.h"
#include "core/highlight/surface/target_surface.h"
#include "core/photometry/intensity.h"

namespace luxrig {

struct DistantBeam {
  Vec3 direction;             ///< unit, from the object to the light
  double illuminance_lx = 1;  ///< on a surface at right angles to it
};

/// A luminaire as a point: E = I(ω) cos θ / d².
struct MountedBeam {
  Vec3 position_world_m;
  Mat3 world_from_lamp;  ///< of frame lamp, core/photometry/intensity.h
  Intensity intensity;
  double level = 1;  ///< of its rated flux
};

/// Aimed along a direction (unit); rotated from straight down by the shortest rotation.
[[nodiscard]] MountedBeam aimed_beam(const Vec3& position_world_m, const Vec3& direction_world, Intensity intensity,
                                     double level = 1);

struct ReliefContrast {
  /// Shadow transition: of two neighbours (ring()), a beam lights one but not the other, because it faces away or is
  /// shaded, or because the beam ends between them.
  double points_with_transition = 0;  ///< share of the interest points with one to any neighbour, for any beam
  double pairs_with_transition = 0;   ///< share of all pairs (interest point, neighbour)
  double local_contrast_lx = 0;       ///< largest difference in illuminance to a neighbour, mean over interest points
  double lit_points = 0;              ///< share of the interest points that at least one beam reaches
  /// Feature coverage: share of the features with a transition at one of their points; 0 if no features are given.
  double features_with_transition = 0;
};

/// interest              indices of points of the surface; if empty, all results are 0
/// feature_of_interest   one per interest point (FeatureClusters), or empty
[[nodiscard]] ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target,
                                             std::span<const std::uint32_t> interest,
                                             std::span<const DistantBeam> beams, double lift_m, int threads,
                                             std::span<const std::uint32_t> feature_of_interest = {});

/// The same for luminaires, which the target and the given surroundings may block.
[[nodiscard]] ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target,
                                             const Surroundings& surroundings, std::span<const std::uint32_t> interest,
                                             std::span<const MountedBeam> beams, double lift_m, int threads,
                                             std::span<const std::uint32_t> feature_of_interest = {});

/// Illuminance [lx] at given points of the surface, as in the measure above.
[[nodiscard]] std::vector<double> illuminance_lx(const TargetSurface& surface, const TargetRays& target,
                                                 const Surroundings& surroundings,
                                                 std::span<const std::uint32_t> points,
                                                 std::span<const MountedBeam> beams, double lift_m, int threads);

}  // namespace luxrig
