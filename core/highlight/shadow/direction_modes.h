#pragma once
/// Where directions gather: mean-shift by angle.

#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct DirectionMode {
  Vec3 direction;  ///< unit
  double weight;   ///< of the directions within the window around it
};

/// Flat kernel: from each start, the mean of all directions within the window takes its place until it moves by less
/// than a thousandth of the window. Directions are first put into bins an eighth of the window wide (not below 0.06°),
/// each with its weight and mean, so the time is that of the bins; starts are means of bins half a window wide. Of
/// modes within a window of one another the heaviest stays. Heaviest first; ties in the order of DirectionBins.
/// directions   unit
/// weights      ≥ 0; directions without weight count for nothing
/// window_rad   0 < window_rad ≤ π (asserted)
[[nodiscard]] std::vector<DirectionMode> direction_modes(std::span<const Vec3f> directions,
                                                         std::span<const double> weights, double window_rad);

}  // namespace luxrig
