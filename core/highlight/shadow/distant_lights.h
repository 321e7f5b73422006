#pragma once
/// Directions of distant lights that bring out an object's relief (thesis §6.4, GP17).

#include <vector>

#include "core/highlight/shadow/direction_bins.h"

namespace luxrig {

struct DistantLightOptions {
  int lights = 1;
  double cut = 0.33;  ///< bins with fewer votes than this share of the largest are dropped
};

struct DistantLight {
  Vec3 direction;       ///< unit, from the object to the light: mean of its bin's votes
  std::uint32_t votes;  ///< of its bin
  double share;         ///< of all votes above the cut: those of its cluster
};

/// K-means over the bins above the cut, weighted by their votes, with the angle between directions as distance. The
/// first mean is the bin with most votes; each next is the bin with the largest votes · angle² from the present means.
/// A cluster is represented by its bin with most votes (ties: the lower bin), not by its mean, which may not be a
/// shadow edge. Clusters with more votes come first. Fewer lights are returned if fewer bins are above the cut. Refuses
/// a histogram without votes (an object without recesses), fewer than one light, and a cut outside 0…1.
[[nodiscard]] Result<std::vector<DistantLight>> distant_lights(const DirectionHistogram& histogram,
                                                               const DistantLightOptions& options);

}  // namespace luxrig
