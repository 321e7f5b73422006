#pragma once
/// Methods from the literature to compare with luxrig's own search: same candidates, same light, same least squares.
/// Where a text leaves something open, the choice is stated here.
///
/// Cause::invalid with PlacementProblem::complaint(), or when a required number of lights is missing.

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

/// Gkaravelis, Papaioannou & Kalampokis 2015 (thesis §5.4): annealing over candidates by complements, then Nelder–Mead
/// on positions within a cell, always with optimal levels. The first start anneals from lights added one by one, later
/// starts from random ones. Needs a number of lights.
[[nodiscard]] Result<FoundLights> place_by_gpk15(const PlacementProblem& problem, const PlacementOptions& options);

/// The same with plain random mutations: annealing without complements. An iteration costs a hundredth, so there are a
/// hundred times as many.
[[nodiscard]] Result<FoundLights> place_by_annealing(const PlacementProblem& problem, const PlacementOptions& options);

/// Gkaravelis & Papaioannou 2016 (thesis §5.5): a light tree (light_tree.h). Its cuts are annealed from few lights to
/// many, starting below ε_opt (or, if none is below, at the first within ε_improv of the least error), until one more
/// light improves by less than ε_improv. Then refined as GPK15. With a given number: the cut of that number.
[[nodiscard]] Result<FoundLights> place_by_gp16(const PlacementProblem& problem, const PlacementOptions& options);

/// Lin et al. 2013: coarse to fine, its own tree (coarse_to_fine.h), and Nelder–Mead on positions and levels at a cut.
/// The candidates serve as its light cache. Open number: starts at the cut beyond which two more lights hardly help,
/// and continues while one more light improves by ε_improv.
[[nodiscard]] Result<FoundLights> place_by_lin2013(const PlacementProblem& problem, const PlacementOptions& options);

/// Non-negative orthogonal matching pursuit; candidates only, no refinement. Open number: the fewest lights beyond
/// which two more hardly help.
[[nodiscard]] Result<FoundLights> place_by_pursuit(const PlacementProblem& problem, const PlacementOptions& options);

}  // namespace luxrig
