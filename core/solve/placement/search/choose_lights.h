#pragma once
/// The number of lights and their places: the thesis's §5.5 ("GP16") with another search.
///
/// The thesis merges the lights of a fine lattice into a tree and walks its cuts downwards. Here lights are added one
/// by one as in place_lights.h until more hardly help, then a few more: with more lights than needed, fewer basins are
/// dead ends. Then they are removed again, each time the one whose loss costs least, while all others are refined and
/// exchanged. Both directions give a curve of error over the number of lights; the best of each number stays.

#include <functional>
#include <vector>

#include "core/solve/placement/number_of_lights.h"
#include "core/solve/placement/other_start.h"

namespace luxrig {

struct ChooseOptions {
  std::size_t max_lights = 64;
  NumberRule number;
  double min_progress = 0.003;  ///< least share of the error that a round over all lights must remove to go on
  /// Limit of columns to compute; the search may exceed it by the columns of one round.
  std::size_t max_columns = 400'000;
  /// Refine fewer lights than chosen as carefully as more, so that the user can pick another number.
  bool whole_curve = false;
  std::uint64_t seed = 1;
  std::vector<LightPose> start;  ///< lights to begin with; empty = none
  OtherStart other;              ///< used without `start`, if the chosen number ends above kHardGoalError
  ExchangeOptions exchange;      ///< its stop ends the search with the best so far
  /// Called from the calling thread when the lights it would choose now are better.
  std::function<void(const PlacedLights& best, std::size_t columns)> better;
};

struct LightCurve {
  std::vector<PlacedLights> cuts;  ///< cuts[k]: best found with k lights, from k = 0; never worse than with fewer
  std::size_t chosen = 0;          ///< index of the chosen cut
  std::size_t columns = 0;         ///< computed, without the candidates'
};

[[nodiscard]] LightCurve choose_lights(const MovableLight& light, const LightingGoal& goal,
                                       const ComplementSearch& candidates, const ChooseOptions& options);

}  // namespace luxrig
