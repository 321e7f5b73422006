#pragma once
/// What points ask for, as solvers take it.

#include <limits>
#include <span>

#include "core/rig/rig.h"

namespace luxrig {

/// A row per point.
struct PointGoals {
  Eigen::VectorXd goal_lx;  ///< NaN: it has none, or none that counts
  Eigen::MatrixXd rgb;      ///< with colours: of the goal, linear Rec. 709 with a luminance of 1; else empty
  Eigen::VectorXd max_lx;   ///< infinity: it has no limit
  Eigen::VectorXd weight;

  [[nodiscard]] bool asks(Eigen::Index point) const { return goal_lx[point] >= 0 && weight[point] > 0; }
  [[nodiscard]] bool limits(Eigen::Index point) const { return max_lx[point] < kNoLimit_lx; }

  static constexpr double kNoLimit_lx = std::numeric_limits<double>::infinity();
};

/// with_colours   of points of which one has a goal with a colour (Rig::colour_goals): only such goals count, and one
///                without is reported, not sought
[[nodiscard]] PointGoals point_goals(std::span<const Point> points, bool with_colours);

}  // namespace luxrig
