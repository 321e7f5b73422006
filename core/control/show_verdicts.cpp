// What the show knows of its points: how bright they are, whether their goals are met and their limits kept
// (core/control/verdict.h has the definition).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/control/show_state.h"

namespace luxrig {
namespace {

const char* name_of_state(Phase phase, bool blackout) {
  if (blackout) return "blackout";
  switch (phase) {
    case Phase::idle:
      return "no plan is applied";
    case Phase::moving:
    case Phase::fading:
    case Phase::correcting:
      return "still fading";
    case Phase::frozen:
      return "the light is held since something failed";
    case Phase::safe_fading:
    case Phase::safe:
      return "safe look";
    default:
      return "";
  }
}

}  // namespace

void ShowController::State::remember_levels(Time now) {
  std::vector<double> level(rig.fixtures.size());
  program.levels_at(now, level);
  for (std::size_t f = 0; f < level.size(); ++f)
    if (!health.lamp_lost(f)) taken_level[f] = level[f];
}

/// Lamps that do not answer may give anything between nothing and all.
LuxEstimate ShowController::State::light_by_model(std::size_t point, std::span<const double> level) const {
  const Prediction prediction = estimator.at_point(point, level);
  LuxEstimate light = estimate_of(prediction.lux, prediction.standard_error_lx);
  light.half_width_lx = std::hypot(light.half_width_lx, estimator.common_tolerance() * prediction.lux);
  std::vector<double> least(level.begin(), level.end()), most = least;
  bool any_lost = false;
  for (std::size_t f = 0; f < least.size(); ++f) {
    if (!health.lamp_lost(f)) continue;
    any_lost = true;
    least[f] = 0;
    most[f] = program.max_level[f];
  }
  if (any_lost)
    light.half_width_lx += std::max(prediction.lux - estimator.at_point(point, least).lux,
                                    estimator.at_point(point, most).lux - prediction.lux);
  return light;
}

PointStatus ShowController::State::point_status(std::size_t p, std::span<const double> level, Time now) const {
  PointStatus status;
  status.goal_lx = rig.points[p].goal_lx;
  const Prediction prediction = estimator.at_point(p, level);
  status.predicted_lx = prediction.lux;
  status.standard_error_lx = prediction.standard_error_lx;
  if (const auto meter = meter_at(p); meter && !health.meter_lost(*meter)) {
    const bool settled = !program.blackout && program.done(now);
    const bool has_sample = settled && measured[*meter] && measured[*meter]->taken >= program.start;
    if (const auto& reading = has_sample ? measured[*meter] : believed[*meter]) {
      status.measured_lx = reading->lux;
      status.measured_at = reading->taken;
    }
  }
  if (p < why.size()) status.why = why[p];
  if (status.measured_lx) {
    const Luxmeter& meter = rig.luxmeters[*meter_at(p)];
    status.light = estimate_of_reading(*status.measured_lx, GainEstimator::kRepeatability, meter.tolerance,
                                       meter.patch.lux_per_count);
  } else {
    status.light = light_by_model(p, level);
  }
  judge_goal(p, level, status);
  judge_limit(p, status);
  return status;
}

void ShowController::State::judge_goal(std::size_t p, std::span<const double> level, PointStatus& status) const {
  if (!status.goal_lx) return;
  double largest_goal_lx = 0;
  for (const Point& point : rig.points) largest_goal_lx = std::max(largest_goal_lx, point.goal_lx.value_or(0));
  const double allowed_lx = tolerance_lx(*status.goal_lx, rig.control.goal_tolerance, largest_goal_lx);
  status.verdict = verdict_of(status.light, *status.goal_lx, allowed_lx);
  const std::string state = name_of_state(phase, program.blackout);
  std::string settles;
  if (const auto meter = meter_at(p); status.measured_lx) {
    settles = fmt::format(
        "luxmeter \"{}\" is good to ± {:.3g} %; one that is better would settle it, or a wider goal_tolerance",
        rig.luxmeters[*meter].name, 100 * rig.luxmeters[*meter].tolerance);
  } else if (meter) {
    settles = fmt::format("luxmeter \"{}\" is lost or not believed; put it right", rig.luxmeters[*meter].name);
  } else {
    for (std::size_t f = 0; f < level.size() && settles.empty(); ++f)
      if (health.lamp_lost(f))
        settles = fmt::format("fixture \"{}\" does not answer; put it right", rig.fixtures[f].name);
    if (settles.empty()) settles = "by the model; a luxmeter here would settle it";
  }
  status.reason = reason_of(*status.verdict, status.light, *status.goal_lx, allowed_lx,
                            state.empty() ? status.why : state, settles);
}

/// Outputs are scaled so that limits hold in the worst case of what is believed (OutputProgram). What speaks against
/// that is a reading: one that is not believed, too, since nobody knows why it is so.
void ShowController::State::judge_limit(std::size_t p, PointStatus& status) const {
  if (!rig.points[p].max_lx) return;
  const double max_lx = *rig.points[p].max_lx;
  status.limit = LimitVerdict::kept;
  const auto meter = meter_at(p);
  if (!meter) return;
  const Luxmeter& luxmeter = rig.luxmeters[*meter];
  const auto& reading = heard[*meter];
  const bool believed_now = status.measured_lx.has_value();
  if (const double lux = status.measured_lx.value_or(reading ? reading->lux : 0);
      lux > max_lx * (1 + luxmeter.tolerance)) {
    status.limit = believed_now ? LimitVerdict::exceeded : LimitVerdict::unknown;
    status.limit_reason =
        believed_now ? fmt::format("luxmeter \"{}\" reads {:.1f} lx, the limit is {:g} lx", luxmeter.name, lux, max_lx)
                     : fmt::format(
                           "luxmeter \"{}\" read {:.1f} lx last, over the limit of {:g} lx, and is lost or not "
                           "believed; measure by hand",
                           luxmeter.name, lux, max_lx);
    return;
  }
  const auto breach =
      std::find_if(breaches.begin(), breaches.end(), [&](const LimitBreach& one) { return one.point == p; });
  if (breach == breaches.end()) return;
  status.limit = LimitVerdict::unknown;
  status.limit_reason = fmt::format(
      "by its luxmeter and that one's tolerance it may have {:.1f} lx, the limit is {:g} lx", breach->most_lx, max_lx);
}

}  // namespace luxrig
