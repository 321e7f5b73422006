#pragma once
/// Lights moved off their candidates by Nelder & Mead's simplex (thesis §5.4.4; Lin et al. 2013), through NLopt.
///
/// The objective is light worked out anew, shadows included, so each evaluation costs a column per light. Where a light
/// may not hang it counts as where it started.

#include <functional>
#include <stop_token>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

struct SimplexOptions {
  bool subplex = false;        ///< Rowan's: the simplex in one subspace of a few unknowns after the other
  double cell_m = 0.3;         ///< farthest a light moves along each axis
  double turn_rad = 0.3;       ///< farthest its aim turns about each of two axes
  double wanted_error = 1e-4;  ///< at which it ends
  double least_change = 1e-4;  ///< of the error, relative, across the simplex: less ends it
  int most_evaluations_per_unknown = 200;
  std::size_t most_columns = 200'000;  ///< ends it, too
  std::stop_token stop;
  std::function<void(const BestSoFar&)> better;  ///< with the columns of this call
};

/// Positions and aims, with the best levels inside: the thesis's hybrid. Never makes the error larger. Returns how many
/// columns were worked out.
std::size_t refine_by_simplex(PlacedLights& lights, const SimplexOptions& options);

/// Positions, aims and levels all as unknowns of the simplex, as Lin et al. do; the levels are made the best ones at
/// its end. `light` and `goal` are those of `lights`.
std::size_t refine_with_levels_by_simplex(PlacedLights& lights, const MovableLight& light, const LightingGoal& goal,
                                          const SimplexOptions& options);

}  // namespace luxrig
