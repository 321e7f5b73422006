#pragma once
/// Several starts of a random method, in parallel.

#include <functional>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

struct PlacementStart {
  int index = 0;
  std::uint64_t seed = 0;
  std::size_t max_columns = 0;                   ///< its share
  std::function<void(const BestSoFar&)> better;  ///< passes on results that are the best of all starts
};

/// Runs options.starts starts and sums their columns. Returns the best, or the first that reaches the wanted error:
/// later starts are then ignored, so the answer does not depend on threads.
[[nodiscard]] FoundLights best_of_starts(const PlacementOptions& options,
                                         const std::function<FoundLights(const PlacementStart&)>& run);

}  // namespace luxrig
