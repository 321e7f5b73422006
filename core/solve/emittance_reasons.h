#pragma once
/// Why a point misses its goal: found out by solving again with the limits, or the level bounds, lifted.

#include <optional>

#include "core/solve/emittance.h"

namespace luxrig {

/// What the lights and what is there anyway give.
struct LightAtPoints {
  Eigen::VectorXd lux;
  Eigen::MatrixXd rgb;  ///< points × 3; empty without colour
};
[[nodiscard]] LightAtPoints light_at_points(const EmittanceProblem& problem, const Eigen::VectorXd& level);

/// What the same problem would give with its max_lx, its max_level, its max_watts (only where that holds) lifted, or
/// all of them.
struct WhatIf {
  LightAtPoints no_max_lx, no_max_level, no_max_watts, none;
  std::optional<LightAtPoints> could_all_dim{};  ///< the lights that are on or off; none: there are none
};

/// What holds points and lights at the solution (to within rounding).
struct Held {
  std::vector<bool> point;  ///< its max_lx binds (with a positive multiplier, or no room left)
  std::vector<bool> light_at_max;
  bool power = false;
};

/// How far a point with a goal is from it: |goal − lux|; with colour, ‖difference of the primaries‖ / √3, which is the
/// same for a difference in white light.
[[nodiscard]] double distance_lx(const EmittanceProblem& problem, Eigen::Index point, const LightAtPoints& light);
/// The goal itself, measured so.
[[nodiscard]] double goal_norm_lx(const EmittanceProblem& problem, Eigen::Index point);

/// Has this point a goal, and is it further from it than 1 % (of the goal; of the largest one where it is 0)?
[[nodiscard]] bool misses_goal(const EmittanceProblem& problem, Eigen::Index point, const LightAtPoints& light);

/// Fills binding, reason, limit_points and limit_lights of a point whose lux and shortfall are set and which misses.
/// The problem must be completed (no empty vectors but names).
void explain(const EmittanceProblem& problem, const Eigen::VectorXd& level, const Held& held, const WhatIf& what_if,
             const LightAtPoints& light, Eigen::Index point, PointOutcome& outcome);

}  // namespace luxrig
