// Which goals a plan meets, by the model.
#include <algorithm>
#include <cmath>

#include "core/plan/plan.h"

namespace luxrig {
namespace {

constexpr double kColourTolerance_uv = 0.02;  ///< visible at a glance, without another colour beside it

Chromaticity uv_of(const Chromaticity& xy) {
  const double scale = -2 * xy.x() + 12 * xy.y() + 3;
  return {4 * xy.x() / scale, 9 * xy.y() / scale};
}

}  // namespace

void judge(Plan& plan, double goal_tolerance) {
  double largest_goal_lx = 0;
  for (const PlannedPoint& point : plan.points) largest_goal_lx = std::max(largest_goal_lx, point.goal_lux.value_or(0));
  for (PlannedPoint& point : plan.points) {
    point.verdict.reset();
    point.reason.clear();
    if (!point.goal_lux) continue;
    const LuxEstimate light = estimate_of(point.lux, point.standard_error_lux);
    const double allowed_lx =
        tolerance_lx(*point.goal_lux, point.goal_tolerance.value_or(goal_tolerance), largest_goal_lx);
    point.verdict = verdict_of(light, *point.goal_lux, allowed_lx);
    point.reason = reason_of(*point.verdict, light, *point.goal_lux, allowed_lx, point.why,
                             "a smaller --max-error would settle it");
    if (point.verdict == Verdict::missed || !point.goal_xy || !point.xy || *point.goal_lux <= 0) continue;
    const double off_uv = (uv_of(*point.xy) - uv_of(*point.goal_xy)).norm();
    if (!(off_uv > kColourTolerance_uv)) continue;
    point.verdict = Verdict::missed;
    point.reason = "not the colour of the goal" + (point.why.empty() ? "" : ": " + point.why);
  }
}

VerdictCounts goals_of(const Plan& plan) {
  VerdictCounts counts;
  for (const PlannedPoint& point : plan.points)
    if (point.verdict) counts.add(*point.verdict);
  return counts;
}

bool nothing_missed(const Plan& plan) {
  return goals_of(plan).missed == 0 &&
         std::all_of(plan.limits.begin(), plan.limits.end(), [](const PlannedLimit& limit) { return limit.met; });
}

}  // namespace luxrig
