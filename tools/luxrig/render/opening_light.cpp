#include "tools/luxrig/render/opening_light.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/estimation/gain_estimator.h"

namespace luxrig {
namespace {

constexpr double kWorthSaying = 0.01;
constexpr std::size_t kMaxLines = 12;

}  // namespace

void add_opening_light(SolvedTasks& solved, const Rig& rig) {
  const auto look = look_for(solved.plan, rig, "plan");
  if (!look || look->levels.size() != solved.rig.fixtures.size()) return;
  const std::vector<double> level = opening_levels(solved.rig, light_model(solved.rig, solved.transport), look->levels);
  const Eigen::Map<const Eigen::VectorXd> levels(level.data(), static_cast<Eigen::Index>(level.size()));
  const std::vector<PlannedPoint> points = predicted_points(solved.rig, solved.transport, levels);
  for (std::size_t i = 0; i < points.size() && i < solved.plan.points.size(); ++i) {
    PlannedPoint& planned = solved.plan.points[i];
    if (points[i].lux < (1 - kWorthSaying) * planned.lux) planned.opening_lux = points[i].lux;
  }
}

std::string opening_light_text(const Plan& plan, const Rig& rig) {
  std::string text;
  std::size_t count = 0;
  for (const PlannedPoint& point : plan.points)
    if (point.opening_lux && ++count <= kMaxLines)
      text += fmt::format("  {}: {:.1f} lx in place of {:.1f} lx\n", point.name, *point.opening_lux, point.lux);
  if (count == 0) return text;
  if (count > kMaxLines)
    text += fmt::format("  and {} more: opening_lux of the points in the plan (-o, --json)\n", count - kMaxLines);
  const bool metered = std::any_of(rig.luxmeters.begin(), rig.luxmeters.end(), [&](const Luxmeter& meter) {
    return meter.point && rig.points[*meter.point].max_lx;
  });
  return fmt::format(
             "a limit is kept with a margin where no luxmeter confirms it (open_loop_margin of [limits], gain_max of "
             "[control]); {} the running rig gives less than this plan:\n",
             metered ? "until one does" : "no luxmeter stands at a limited point, so") +
         text;
}

}  // namespace luxrig
