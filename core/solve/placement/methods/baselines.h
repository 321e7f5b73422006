#pragma once
/// What luxrig's own search is compared with: the methods of the literature, on the same candidates, the same light and
/// the same least squares. Where a text leaves something open, the choice made is said here.
///
/// Cause::invalid with PlacementProblem::complaint(), or when a number of lights is needed and not given.

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

/// Gkaravelis, Papaioannou & Kalampokis 2015 (thesis §5.4): annealing over candidates by complements, then Nelder–Mead
/// on positions within a cell, best levels throughout. The first start anneals from lights added one by one, later ones
/// from drawn ones. A given number of lights.
[[nodiscard]] Result<FoundLights> place_by_gpk15(const PlacementProblem& problem, const PlacementOptions& options);

/// The same with plain random mutations: annealing as it was before complements. Its iterations cost a hundredth, so
/// there are a hundred times as many.
[[nodiscard]] Result<FoundLights> place_by_annealing(const PlacementProblem& problem, const PlacementOptions& options);

/// Gkaravelis & Papaioannou 2016 (thesis §5.5): a light tree (light_tree.h), its cuts from few lights to many, those
/// below ε_opt (where none is, those from the first that is within ε_improv of the least error) annealed until one more
/// light improves by less than ε_improv, then refined as GPK15. With a given number: the cut of that number.
[[nodiscard]] Result<FoundLights> place_by_gp16(const PlacementProblem& problem, const PlacementOptions& options);

/// Lin et al. 2013: coarse to fine, its own tree (coarse_to_fine.h), and Nelder–Mead on positions and levels at a cut.
/// The candidates serve as its light cache. Open number: from the cut beyond which two more lights hardly help, on
/// while one more light improves by ε_improv.
[[nodiscard]] Result<FoundLights> place_by_lin2013(const PlacementProblem& problem, const PlacementOptions& options);

/// Non-negative orthogonal matching pursuit; candidates only, no refinement. Open number: the fewest lights beyond
/// which two more hardly help.
[[nodiscard]] Result<FoundLights> place_by_pursuit(const PlacementProblem& problem, const PlacementOptions& options);

}  // namespace luxrig
