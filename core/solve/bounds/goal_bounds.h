#pragma once
/// Certified lower bounds (error_bound.h) on PlacedLights::error() of lights at candidates, for a lighting goal with
/// its channels, emitters, weights and fixed light. Limits on level, lux and watts are ignored: a bound without them
/// also holds with them.

#include "core/solve/bounds/error_bound.h"
#include "core/solve/placement/lighting_goal.h"

namespace luxrig {

/// Any number of lights. columns: of the candidates, lux per unit emittance, one row per point. 0 when stopped.
[[nodiscard]] double goal_error_bound(const ColumnsView& columns, const LightingGoal& goal,
                                      const std::stop_token& stop = {});

/// [k]: at most k lights. Guesses, if any, are as PlacedLights::residual(): W (b − f − A x).
[[nodiscard]] std::vector<double> goal_error_bounds_by_count(const ColumnsView& columns, const LightingGoal& goal,
                                                             const CountBoundOptions& options);

}  // namespace luxrig
