#include "core/rig/point_goals.h"

namespace luxrig {

PointGoals point_goals(std::span<const Point> points, bool with_colours) {
  const auto count = static_cast<Eigen::Index>(points.size());
  PointGoals goals;
  goals.goal_lx.setConstant(count, std::numeric_limits<double>::quiet_NaN());
  goals.max_lx.setConstant(count, PointGoals::kNoLimit_lx);
  goals.weight.resize(count);
  if (with_colours) goals.rgb.setOnes(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point& point = points[static_cast<std::size_t>(i)];
    if (point.goal_lx && (point.goal_rgb || !with_colours)) goals.goal_lx[i] = *point.goal_lx;
    if (point.goal_rgb && with_colours) goals.rgb.row(i) = point.goal_rgb->transpose();
    if (point.max_lx) goals.max_lx[i] = *point.max_lx;
    goals.weight[i] = point.weight;
  }
  return goals;
}

}  // namespace luxrig
