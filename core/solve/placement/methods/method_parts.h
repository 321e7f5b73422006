#pragma once
/// Parts that the baselines share, besides annealing.

#include <optional>

#include "core/solve/placement/methods/chosen_candidates.h"
#include "core/solve/placement/methods/simplex_refine.h"

namespace luxrig {

/// Cause::invalid: the method needs a number of lights.
[[nodiscard]] std::optional<Fault> missing_number(const PlacementOptions& options);

/// Simplex options for lights at candidates, with `columns` of the budget already used.
[[nodiscard]] SimplexOptions simplex_of(const PlacementProblem& problem, const PlacementOptions& options,
                                        std::size_t max_columns, std::size_t columns,
                                        const std::function<void(const BestSoFar&)>& better);

/// Reports lights at candidates.
[[nodiscard]] std::function<void(const ChosenCandidates&)> reporter(const std::function<void(const BestSoFar&)>& better,
                                                                    const std::size_t& columns);

/// Of (lights, error), fewest first: by luxrig's own rule (number_of_lights.h).
[[nodiscard]] std::size_t fewest_worth_it(const std::vector<std::pair<std::size_t, double>>& cuts,
                                          const PlacementOptions& options);

}  // namespace luxrig
