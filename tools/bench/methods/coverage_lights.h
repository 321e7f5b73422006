#pragma once
/// Distant lights that light as much of a surface as possible: the method to compare highlighting with (thesis §6.5.5,
/// "maximum surface coverage").

#include <vector>

#include "core/highlight/shadow/direction_bins.h"
#include "core/highlight/surface/target_surface.h"

namespace luxrig {

struct CoverageLight {
  Vec3 direction;    ///< unit, from the object to the light; the middle of a bin
  double new_share;  ///< share of the surface's area that it lights and earlier lights do not
};

/// Every point of the surface votes, with its area, for the middle of each bin from which light reaches it. The bin
/// with most votes is taken (on a tie, the lower one), and the votes of the points that it lights are removed from all
/// other bins. This repeats, and ends early when no bin lights anything more.
/// max_points   a larger surface is judged by evenly strided points; 0 = all
/// The same for any number of threads.
[[nodiscard]] std::vector<CoverageLight> coverage_lights(const TargetSurface& surface, const TargetRays& target,
                                                         const DirectionBins& bins, int lights, std::size_t max_points,
                                                         int threads);

}  // namespace luxrig
