#pragma once
/// Where an object has relief worth showing: recessed places.

#include <optional>
#include <vector>

#include "core/highlight/surface/curvature.h"

namespace luxrig {

struct InterestOptions {
  /// Points with a mean curvature below this count [1/m], if given; must be negative. Else `wanted_share`.
  std::optional<double> mean_curvature_below_per_m;
  /// Share of the surface's area (as far as its curvature is known) that should count, the most recessed first.
  double wanted_share = 0.1;
  /// Not recessed at all: where the surface turns by less than this over the radius of its fit [rad], or by less than
  /// twice the standard error of the curvature.
  double least_turn_rad = 0.02;
  /// At most so many points; 0: any number. More are thinned out evenly: the most recessed of each cell of a grid that
  /// is as fine as that allows.
  std::size_t most_points = 0;
};

/// Indices of points of the surface, rising. Empty for an object without recesses (a plain sphere, a plane).
/// Refuses a threshold that is not negative, a share outside 0…1, and curvatures that are not one per point.
[[nodiscard]] Result<std::vector<std::uint32_t>> interest_points(const TargetSurface& surface,
                                                                 const std::vector<Curvature>& curvature,
                                                                 const InterestOptions& options);

}  // namespace luxrig
