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
  double share;         ///< of all votes above the cut, those of its cluster
};

/// Bins above the cut are clustered by k-means, a bin weighing as its votes, with the angle between directions as
/// distance; the first means are the bin with most votes, then one by one the bin with the largest votes · angle² from
/// those there are. Each cluster is represented by its bin with most votes (ties: the lower bin), not by its mean,
/// which may be no shadow edge at all. Clusters with more votes come first. Fewer lights than asked for where fewer
/// bins are above the cut. Refuses a histogram without votes (an object without recesses: nothing to bring out), fewer
/// than one light, and a cut outside 0…1.
[[nodiscard]] Result<std::vector<DistantLight>> distant_lights(const DirectionHistogram& histogram,
                                                               const DistantLightOptions& options);

}  // namespace luxrig
