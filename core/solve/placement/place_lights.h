#pragma once
/// Moves a given number of lights to where they meet a goal best: the thesis's §5.4 ("GPK15") with another search.
///
/// Lights are added one by one, each the candidate that lowers the error most. After each, all places are refined
/// together with all levels (a sliding Frank–Wolfe: Boyd, Schiebinger & Recht 2017; Denoyelle et al. 2020). Then lights
/// are exchanged (exchange_lights.h): singly until that no longer helps, then in pairs, then through more lights than
/// wanted. If that does not help either, another start begins, with other choices among the best. A hard goal also gets
/// another kind of start (other_start.h), and the search continues with the better of the two.

#include <functional>

#include "core/solve/placement/other_start.h"

namespace luxrig {

struct PlaceOptions {
  std::size_t lights = 1;
  double wanted_error = 1e-4;  ///< PlacedLights::error(); ends the search
  /// Limit of columns to compute; the search may exceed it by the columns of one round.
  std::size_t max_columns = 200'000;
  int max_idle_starts = 2;      ///< this many starts in a row without improvement also end it
  double min_progress = 0.003;  ///< least share of the error that a round over all lights must remove to go on
  std::uint64_t seed = 1;
  std::vector<LightPose> start{};  ///< lights to begin with, at most as many as wanted; empty = none
  OtherStart other{};              ///< used without `start`, if lights added one by one end above kHardGoalError
  ExchangeOptions exchange;        ///< its stop ends the search with the best so far
  /// Called from the calling thread with each new best result.
  std::function<void(const PlacedLights& best, std::size_t columns)> better;
};

struct Placement {
  PlacedLights lights;
  std::size_t columns = 0;  ///< computed, without the candidates'
  int starts = 0;
};

[[nodiscard]] Placement place_lights(const MovableLight& light, const LightingGoal& goal,
                                     const ComplementSearch& candidates, const PlaceOptions& options);

}  // namespace luxrig
