#pragma once
/// The thesis's methods: on the same candidates, light and least squares as luxrig's own search. Where a text leaves
/// something open, the choice is stated here. tools/bench/methods has those that exist only to compare with.
///
/// Cause::invalid with PlacementProblem::complaint(), or when a required number of lights is missing.

#include "core/solve/placement/methods/anneal_candidates.h"
#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

/// Gkaravelis, Papaioannou & Kalampokis 2015 (thesis §5.4): annealing over candidates by complements, then Nelder–Mead
/// on positions within a cell, always with optimal levels. The first start anneals from lights added one by one, later
/// starts from random ones. Needs a number of lights.
[[nodiscard]] Result<FoundLights> place_by_gpk15(const PlacementProblem& problem, const PlacementOptions& options);

/// What gpk15 is made of: the best of several annealings over candidates, refined. annealing: its iterations, unless
/// the options give them, and its mutations.
[[nodiscard]] Result<FoundLights> annealed_and_refined(const PlacementProblem& problem, const PlacementOptions& options,
                                                       AnnealOptions annealing);

/// Gkaravelis & Papaioannou 2016 (thesis §5.5): a light tree (light_tree.h). Its cuts are annealed from few lights to
/// many, starting below ε_opt (or, if none is below, at the first within ε_improv of the least error), until one more
/// light improves by less than ε_improv. Then refined as GPK15. With a given number: the cut of that number.
[[nodiscard]] Result<FoundLights> place_by_gp16(const PlacementProblem& problem, const PlacementOptions& options);

}  // namespace luxrig
