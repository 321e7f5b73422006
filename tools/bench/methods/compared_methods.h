#pragma once
/// Placement methods that exist only to compare luxrig's own with: same candidates, same light, same least squares.
/// Where a text leaves something open, the choice is stated here.
///
/// Cause::invalid with PlacementProblem::complaint(), or when a required number of lights is missing.

#include <span>
#include <string_view>
#include <vector>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

/// gpk15 with plain random mutations: annealing without complements. An iteration costs a hundredth, so there are a
/// hundred times as many.
[[nodiscard]] Result<FoundLights> place_by_annealing(const PlacementProblem& problem, const PlacementOptions& options);

/// Lin et al. 2013: coarse to fine, its own tree (coarse_to_fine.h), and Nelder–Mead on positions and levels at a cut.
/// The candidates serve as its light cache. Open number: starts at the cut beyond which two more lights hardly help,
/// and continues while one more light improves by ε_improv.
[[nodiscard]] Result<FoundLights> place_by_lin2013(const PlacementProblem& problem, const PlacementOptions& options);

/// Non-negative orthogonal matching pursuit; candidates only, no refinement. Open number: the fewest lights beyond
/// which two more hardly help.
[[nodiscard]] Result<FoundLights> place_by_pursuit(const PlacementProblem& problem, const PlacementOptions& options);

/// Those of a rig file (placement_methods.h), luxrig's own first, then those above, and the thesis's with Rowan's
/// subplex in place of a simplex that is known to fail with many unknowns.
[[nodiscard]] const std::vector<PlacementMethod>& compared_methods();

/// nullptr if there is none of that name.
[[nodiscard]] const PlacementMethod* find_compared_method(std::string_view name);

}  // namespace luxrig
