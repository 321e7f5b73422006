#pragma once
/// A given number of lights to where they light a goal best: the thesis's §5.4 ("GPK15") with another search.
///
/// Lights are added one by one, each the candidate that lowers the error most, and after each all places are refined
/// together with all levels (a sliding Frank–Wolfe: Boyd, Schiebinger & Recht 2017; Denoyelle et al. 2020). Then they
/// are exchanged (exchange_lights.h), singly until that helps no more, then by twos, then through more lights than are
/// wanted; when that does not help either, another start begins, with other choices among the best.
/// A hard goal is begun in another way, too (other_start.h), and the better of the two is gone on with.

#include <functional>

#include "core/solve/placement/other_start.h"

namespace luxrig {

struct PlaceOptions {
  std::size_t lights = 1;
  double wanted_error = 1e-4;  ///< PlacedLights::error() at which the search ends
  /// Columns to work out before it ends anyway; it may go over by those of one round.
  std::size_t most_columns = 200'000;
  int most_idle_starts = 2;       ///< starts in a row that find nothing better end it, too
  double least_progress = 0.003;  ///< share of the error that a round over all lights must take away, or is the last
  std::uint64_t seed = 1;
  std::vector<LightPose> start{};  ///< lights to begin with, as many as are wanted or fewer; none: from the first
  OtherStart other{};              ///< asked without `start`, where lights added one by one end above kHardGoalError
  ExchangeOptions exchange;        ///< its stop ends the search, with the best so far
  /// Called with the best so far when there is a better one, from the calling thread.
  std::function<void(const PlacedLights& best, std::size_t columns)> better;
};

struct Placement {
  PlacedLights lights;
  std::size_t columns = 0;  ///< worked out anew, beside the candidates'
  int starts = 0;
};

[[nodiscard]] Placement place_lights(const MovableLight& light, const LightingGoal& goal,
                                     const ComplementSearch& candidates, const PlaceOptions& options);

}  // namespace luxrig
