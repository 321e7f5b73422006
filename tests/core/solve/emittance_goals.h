#pragma once
/// Targets of an EmittanceProblem, computed independently for the tests.

#include <algorithm>
#include <cmath>

#include "core/solve/emittance.h"

namespace luxrig {

/// Lux that the lights should add at a point; 0 where fixed light exceeds the goal.
inline double missing_lx(const EmittanceProblem& p, Eigen::Index point) {
  return std::max(0.0, p.goal_lx[point] - p.fixed_lx[point]);
}

/// Σ w² (T c − missing)² over points with a goal.
inline double objective(const EmittanceProblem& p, const Eigen::VectorXd& level) {
  double sum = 0;
  for (Eigen::Index i = 0; i < p.goal_lx.size(); ++i)
    if (!std::isnan(p.goal_lx[i]))
      sum += std::pow(p.weight[i] * (p.lux_per_level.row(i).dot(level) - missing_lx(p, i)), 2);
  return sum;
}

}  // namespace luxrig
