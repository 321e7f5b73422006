#pragma once
/// What the baselines share beside annealing.

#include <optional>

#include "core/solve/placement/methods/chosen_candidates.h"
#include "core/solve/placement/methods/simplex_refine.h"

namespace luxrig {

/// Cause::invalid: the method wants to be told how many lights.
[[nodiscard]] std::optional<Fault> missing_number(const PlacementOptions& options);

/// Of the simplex for lights that stand on candidates, `columns` of its budget gone.
[[nodiscard]] SimplexOptions simplex_of(const PlacementProblem& problem, const PlacementOptions& options,
                                        std::size_t most_columns, std::size_t columns,
                                        const std::function<void(const BestSoFar&)>& better);

/// Reports lights at candidates.
[[nodiscard]] std::function<void(const ChosenCandidates&)> reporter(const std::function<void(const BestSoFar&)>& better,
                                                                    const std::size_t& columns);

/// Of (lights, error), fewest first: by the rule of luxrig's own (number_of_lights.h).
[[nodiscard]] std::size_t fewest_worth_it(const std::vector<std::pair<std::size_t, double>>& cuts,
                                          const PlacementOptions& options);

}  // namespace luxrig
