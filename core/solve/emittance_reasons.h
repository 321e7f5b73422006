#pragma once
/// Why a point misses its goal: found out by solving again with the limits, or the level bounds, lifted.

#include "core/solve/emittance.h"

namespace luxrig {

/// Lux that the same problem would give with its max_lx, its max_level, or both lifted.
struct WhatIf {
  Eigen::VectorXd no_max_lx, no_max_level, neither;
};

/// What holds points and lights at the solution (to within rounding).
struct Held {
  std::vector<bool> point;  ///< its max_lx binds (with a positive multiplier, or no room left)
  std::vector<bool> light_at_max;
};

/// Has this point a goal, and is lux further from it than 1 % (of the goal; of the largest one where it is 0)?
[[nodiscard]] bool misses_goal(const EmittanceProblem& problem, Eigen::Index point, double lux);

/// Fills binding, reason, limit_points and limit_lights of a point whose lux and shortfall are set and which misses.
/// The problem must be completed (no empty vectors but names).
void explain(const EmittanceProblem& problem, const Eigen::VectorXd& level, const Held& held, const WhatIf& what_if,
             Eigen::Index point, PointOutcome& outcome);

}  // namespace luxrig
