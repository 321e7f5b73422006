#pragma once
/// A given number of lights to where they light a goal best: the thesis's §5.4 ("GPK15") with another search.
///
/// Lights are added one by one, each the candidate that lowers the error most, and after each all places are refined
/// together with all levels (a sliding Frank–Wolfe: Boyd, Schiebinger & Recht 2017; Denoyelle et al. 2020). That ends
/// in basins which shadows cut off. So lights are then taken out in turn and put where they do most for what is left
/// over: at a candidate anywhere, or at a fresh place near by, which may lie beyond an edge of a shadow. Whatever
/// lowers the error after refinement is kept. When nothing does, two lights that share points are taken out together;
/// when that does not help either, another start begins, with other choices among the best.

#include <functional>
#include <stop_token>

#include "core/solve/placement/complement_search.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

struct PlaceOptions {
  std::size_t lights = 1;
  double wanted_error = 1e-4;  ///< PlacedLights::error() at which the search ends
  /// Columns to work out before it ends anyway; it may go over by those of one round.
  std::size_t most_columns = 200'000;
  std::size_t complements = 6;   ///< candidates tried for a light that was taken out
  std::size_t near_places = 48;  ///< places tried about it
  double apart_m = 0.5;          ///< between candidates that are tried
  double near_m = 0.4;           ///< of those places: standard deviation along each axis
  std::uint64_t seed = 1;
  int threads = 0;       ///< 0 = one per core; the result does not depend on it
  std::stop_token stop;  ///< returns the best so far
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
