#pragma once
/// Lights moved off their candidates by Nelder & Mead's simplex (thesis §5.4.4; Lin et al. 2013), through NLopt.
///
/// The objective is recomputed light, shadows included, so each evaluation costs one column per light. A pose where a
/// light may not hang counts as its start.

#include <functional>
#include <stop_token>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

struct SimplexOptions {
  bool subplex = false;        ///< Rowan's: the simplex in successive subspaces of a few unknowns
  double cell_m = 0.3;         ///< largest move of a light along each axis
  double turn_rad = 0.3;       ///< largest turn of its aim about each of two axes
  double wanted_error = 1e-4;  ///< ends the search
  double min_change = 1e-4;    ///< relative change of the error across the simplex; less ends the search
  int max_evaluations_per_unknown = 200;
  std::size_t max_columns = 200'000;  ///< also ends the search
  std::stop_token stop;
  std::function<void(const BestSoFar&)> better;  ///< with the columns of this call
};

/// Positions and aims, with optimal levels inside: the thesis's hybrid. Never increases the error. Returns the number
/// of computed columns.
std::size_t refine_by_simplex(PlacedLights& lights, const SimplexOptions& options);

/// Positions, aims and levels are all unknowns of the simplex, as in Lin et al.; the levels are optimised at the end.
/// `light` and `goal` are those of `lights`.
std::size_t refine_with_levels_by_simplex(PlacedLights& lights, const MovableLight& light, const LightingGoal& goal,
                                          const SimplexOptions& options);

}  // namespace luxrig
