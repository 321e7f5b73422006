#pragma once
/// How many lights, and where: the thesis's §5.5 ("GP16") with another search.
///
/// The thesis merges the lights of a fine lattice into a tree and walks its cuts downwards. Here lights are added one
/// by one as in place_lights.h until more hardly help, a few more than that, since with more lights than needed fewer
/// basins are dead ends, and then taken out again, each time the one that is missed least, all others refined and
/// exchanged meanwhile. Both ways give a curve of error over the number of lights; the best of each number stays.

#include <functional>
#include <vector>

#include "core/solve/placement/number_of_lights.h"
#include "core/solve/placement/other_start.h"

namespace luxrig {

struct ChooseOptions {
  std::size_t most_lights = 64;
  NumberRule number;
  double least_progress = 0.003;  ///< share of the error that a round over all lights must take away, or is the last
  /// Columns to work out before it ends anyway; it may go over by those of one round.
  std::size_t most_columns = 400'000;
  /// Fewer lights than are chosen are looked at as closely as more: for a person who picks another number.
  bool whole_curve = false;
  std::uint64_t seed = 1;
  std::vector<LightPose> start;  ///< lights to begin with; none: from the first
  OtherStart other;              ///< asked without `start`, where the chosen number ends above kHardGoalError
  ExchangeOptions exchange;      ///< its stop ends the search, with the best so far
  /// Called when the lights it would choose now are better, from the calling thread.
  std::function<void(const PlacedLights& best, std::size_t columns)> better;
};

struct LightCurve {
  std::vector<PlacedLights> cuts;  ///< cuts[k]: the best found of k lights, from none on; never worse than with fewer
  std::size_t chosen = 0;          ///< which of them
  std::size_t columns = 0;         ///< worked out anew, beside the candidates'
};

[[nodiscard]] LightCurve choose_lights(const MovableLight& light, const LightingGoal& goal,
                                       const ComplementSearch& candidates, const ChooseOptions& options);

}  // namespace luxrig
