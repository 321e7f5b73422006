#pragma once
/// Interest points grouped into contiguous features (thesis §6.5.1).

#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"

namespace luxrig {

struct FeatureOptions {
  double link_m = 0;  ///< points farther apart than this are not neighbours
  double largest_angle_rad = rad_from_deg(36);
};

struct FeatureClusters {
  std::vector<std::uint32_t> cluster_of_point;  ///< numbered by their first points
  std::vector<std::uint32_t> sizes;             ///< per cluster
};

/// Single linkage: pairs of neighbours, nearest first (ties in the order of the points), join their clusters if the
/// clusters' mean normals are within the angle; a single point has its own normal. A rejected pair is not tried again.
/// Neighbours of a point are its twelve nearest within link_m, so the time is O(n log n). Refuses a link that is not
/// positive and finite, and points that are not finite.
[[nodiscard]] Result<FeatureClusters> cluster_features(std::span<const OrientedPoint> points,
                                                       const FeatureOptions& options);

}  // namespace luxrig
