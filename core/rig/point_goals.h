#pragma once
/// Goals and limits of points, in the form that solvers take.

#include <limits>
#include <span>

#include "core/rig/brief.h"

namespace luxrig {

/// A row per point.
struct PointGoals {
  Eigen::VectorXd goal_lx;  ///< NaN: no goal, or none that counts
  Eigen::MatrixXd rgb;      ///< with colours: of the goal, linear Rec. 709, luminance 1; else empty
  Eigen::VectorXd max_lx;   ///< infinity: no limit
  Eigen::VectorXd weight;

  [[nodiscard]] bool asks(Eigen::Index point) const { return goal_lx[point] >= 0 && weight[point] > 0; }
  [[nodiscard]] bool limits(Eigen::Index point) const { return max_lx[point] < kNoLimit_lx; }

  static constexpr double kNoLimit_lx = std::numeric_limits<double>::infinity();
};

/// with_colours: at least one point's goal has a colour (Rig::colour_goals). Then only goals with a colour count; the
/// others are reported, not sought.
[[nodiscard]] PointGoals point_goals(std::span<const Point> points, bool with_colours);

}  // namespace luxrig
