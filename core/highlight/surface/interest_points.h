#pragma once
/// Recessed places: where an object has relief worth showing.

#include <optional>
#include <vector>

#include "core/highlight/surface/curvature.h"

namespace luxrig {

struct InterestOptions {
  /// If given, points with a mean curvature below this [1/m] count; must be negative. Otherwise `wanted_share` decides.
  std::optional<double> mean_curvature_below_per_m;
  /// Share of the surface's area (where its curvature is known) that should count, the most recessed first.
  double wanted_share = 0.1;
  /// A place is not recessed if the surface turns by less than this over the radius of its fit [rad], or by less than
  /// twice the standard error of the curvature.
  double min_turn_rad = 0.02;
  /// Upper limit of points; 0 = none. If there are more, the most recessed of each cell of a grid stays, with the
  /// finest grid that keeps the limit.
  std::size_t max_points = 0;
};

/// Indices of points of the surface, rising. Empty for an object without recesses (a plain sphere, a plane).
/// Refuses a threshold that is not negative, a share outside 0…1, and curvatures that are not one per point.
[[nodiscard]] Result<std::vector<std::uint32_t>> interest_points(const TargetSurface& surface,
                                                                 const std::vector<Curvature>& curvature,
                                                                 const InterestOptions& options);

}  // namespace luxrig
