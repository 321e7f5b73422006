#include "core/plan/uniformity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/text/plain_text.h"

namespace luxrig {

std::vector<Uniformity> uniformities(const Rig& rig, std::span<const LuxEstimate> light) {
  LUXRIG_CHECK(light.size() == rig.points.size(), "{} of {} points", light.size(), rig.points.size());
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  struct Sum {
    double lowest = kUnknown, sum = 0;
    void add(double lux, double share) {
      lowest = std::min(lowest, lux);
      sum += share * lux;
    }
  };
  std::vector<Uniformity> all;
  for (std::size_t g = 0; g < rig.surface_goals.size(); ++g) {
    const SurfaceGoalSpec& goal = rig.surface_goals[g];
    if (!goal.uniformity) continue;
    Sum best, low, high;
    double shares = 0;
    for (std::size_t i = 0; i < rig.points.size(); ++i) {
      const Point& point = rig.points[i];
      if (point.surface_goal != g) continue;
      const double share = goal.weight > 0 ? point.weight : 1;  // a point's weight is its area's share of the goal's
      const double half_lx = std::isnan(light[i].half_width_lx) ? kUnknown : light[i].half_width_lx;
      shares += share;
      best.add(light[i].lux, share);
      low.add(std::max(0.0, light[i].lux - half_lx), share);
      high.add(light[i].lux + half_lx, share);
    }
    if (!(best.sum > 0)) continue;  // no points, or all dark
    Uniformity one{goal.name, *goal.uniformity, shares * best.lowest / best.sum, 0, 1, Verdict::unknown};
    if (std::isfinite(high.sum)) one.low = shares * low.lowest / high.sum;
    if (low.sum > 0) one.high = std::min(1.0, shares * high.lowest / low.sum);
    if (one.low >= one.wanted) one.verdict = Verdict::met;
    if (one.high < one.wanted) one.verdict = Verdict::missed;
    all.push_back(std::move(one));
  }
  return all;
}

std::string text_of(const Uniformity& uniformity) {
  return fmt::format("{}: uniformity {:.2f} ({:.2f} to {:.2f}), wanted {:g}: {}", made_plain(uniformity.surface_goal),
                     uniformity.share, uniformity.low, uniformity.high, uniformity.wanted, name_of(uniformity.verdict));
}

}  // namespace luxrig
