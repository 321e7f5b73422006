#pragma once
/// Clusters of directions: mean-shift by angle.

#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct DirectionMode {
  Vec3 direction;  ///< unit
  double weight;   ///< of the directions within the window around it
};

/// Flat kernel: each start is replaced by the mean of all directions within the window, until it moves by less than a
/// thousandth of the window. Directions are first collected in bins of an eighth of the window (at least 0.06°), each
/// with its weight and mean, so the time depends on the bins. Starts are means of bins half a window wide. Of modes
/// within a window of each other the heaviest stays. Heaviest first; ties in the order of DirectionBins.
/// directions   unit
/// weights      ≥ 0; directions of weight 0 are ignored
/// window_rad   0 < window_rad ≤ π (asserted)
[[nodiscard]] std::vector<DirectionMode> direction_modes(std::span<const Vec3f> directions,
                                                         std::span<const double> weights, double window_rad);

}  // namespace luxrig
