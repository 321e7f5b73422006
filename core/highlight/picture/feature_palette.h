#pragma once
/// Few colours for many features, so that neighbours differ.

#include <cstdint>
#include <span>
#include <vector>

#include "core/highlight/surface/feature_clusters.h"

namespace luxrig {

/// A colour, 0…colours - 1, per cluster. Clusters are neighbours where points of theirs are within near_m of each
/// other. The largest is served first; each takes the first colour that none of its neighbours has, or else the one
/// that the fewest have (ties: the first).
/// requires colours ≥ 1 (asserted), one cluster per point
[[nodiscard]] std::vector<std::uint32_t> feature_colours(std::span<const OrientedPoint> points,
                                                         const FeatureClusters& features, double near_m,
                                                         std::uint32_t colours);

}  // namespace luxrig
