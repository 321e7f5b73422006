#pragma once
/// A method that draws at random, begun several times over threads.

#include <functional>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

struct PlacementStart {
  int index = 0;
  std::uint64_t seed = 0;
  std::size_t most_columns = 0;                  ///< its share
  std::function<void(const BestSoFar&)> better;  ///< passes on what is better than all of all starts
};

/// Runs options.starts of them, with their columns summed; the best, or the first that reaches the wanted error: starts
/// after it count for nothing, so the answer does not depend on threads.
[[nodiscard]] FoundLights best_of_starts(const PlacementOptions& options,
                                         const std::function<FoundLights(const PlacementStart&)>& run);

}  // namespace luxrig
