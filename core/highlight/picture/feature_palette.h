#pragma once
/// A few colours for many features, so that neighbours differ.

#include <cstdint>
#include <span>
#include <vector>

#include "core/highlight/surface/feature_clusters.h"

namespace luxrig {

/// One colour, 0…colours - 1, per cluster. Clusters are neighbours if any of their points are within near_m of each
/// other. Largest cluster first; each takes the first colour that no neighbour has, or else the one that the fewest
/// have (ties: the first).
/// Asserted: colours ≥ 1, one cluster per point.
[[nodiscard]] std::vector<std::uint32_t> feature_colours(std::span<const OrientedPoint> points,
                                                         const FeatureClusters& features, double near_m,
                                                         std::uint32_t colours);

}  // namespace luxrig
