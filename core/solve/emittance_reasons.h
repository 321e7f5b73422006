#pragma once
/// Why a point misses its goal: the problem is solved again without its limits, or without its level bounds.

#include <optional>

#include "core/solve/emittance.h"

namespace luxrig {

/// Light of the lights and the fixed light together.
struct LightAtPoints {
  Eigen::VectorXd lux;
  Eigen::MatrixXd rgb;  ///< points × 3; empty without colour
};
[[nodiscard]] LightAtPoints light_at_points(const EmittanceProblem& problem, const Eigen::VectorXd& level);

/// Light of the same problem without max_lx, without max_level, without max_watts (set only if that binds), and without
/// all three.
struct WhatIf {
  LightAtPoints no_max_lx, no_max_level, no_max_watts, none;
  std::optional<LightAtPoints> could_all_dim{};  ///< with all switched lights dimmable; empty = no light is switched
};

/// Binding constraints of points and lights at the solution (to within rounding).
struct Held {
  std::vector<bool> point;  ///< its max_lx binds (positive multiplier, or no room left)
  std::vector<bool> light_at_max;
  bool power = false;
};

/// Distance of a point from its goal: |goal − lux|; with colour, ‖difference of the primaries‖ / √3, which is equal for
/// a difference in white light.
[[nodiscard]] double distance_lx(const EmittanceProblem& problem, Eigen::Index point, const LightAtPoints& light);
/// The goal itself in the same measure.
[[nodiscard]] double goal_norm_lx(const EmittanceProblem& problem, Eigen::Index point);

/// Whether this point has a goal and misses it by more than 1 % (of the goal; of the largest goal if it is 0).
[[nodiscard]] bool misses_goal(const EmittanceProblem& problem, Eigen::Index point, const LightAtPoints& light);

/// Fills binding, reason, limit_points and limit_lights of a point that misses its goal; its lux and shortfall must be
/// set. The problem must be completed (no empty vectors except names).
void explain(const EmittanceProblem& problem, const Eigen::VectorXd& level, const Held& held, const WhatIf& what_if,
             const LightAtPoints& light, Eigen::Index point, PointOutcome& outcome);

}  // namespace luxrig
