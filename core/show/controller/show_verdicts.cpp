// Status of points: how bright they are, whether their goals are met and their limits kept (core/plan/verdict.h has the
// definition).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

/// A lamp's light at a meter is known only as well as the model. So it must exceed the meter's smallest jump by this
/// factor.
constexpr double kSurelySeen = 1.5;
/// A calibration that lit a lamp alone and knew its output better than this, as a share, saw it burn.
constexpr double kSawItBurn = 0.3;
/// For so long a lamp is believed to burn on. Of lamps that last 50,000 h, one in a hundred goes out in this time.
constexpr double kBurnsOn_h = 500;

/// Why the light is not the plan's; empty if it is.
const char* why_not_the_plan(Phase phase, bool blackout) {
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
  lost.remember_levels(health, level);
  for (const std::optional<LuxReading>& reading : readings.heard())
    if (reading) estimator.shows(*reading, lost.taken_level());
}

std::vector<double> ShowController::State::levels_out(Time now) const {
  std::vector<double> level(rig.fixtures.size());
  program.levels_at(now, level);
  for (const DeskBlend& desk : program.desks)
    for (std::size_t i = 0; desk.silent && i < desk.fixtures.size(); ++i)
      if (desk.desk_has[i] != 0) level[desk.fixtures[i]] = desk.desk_level[i];
  for (std::size_t f = 0; f < level.size(); ++f)
    if (health.lamp_silent(f)) level[f] = lost.taken_level()[f];
  return level;
}

/// Lamps that do not answer may give anything from nothing to full.
std::vector<double> ShowController::State::with_lost_lamps_at(std::span<const double> level, bool full) const {
  std::vector<double> out(level.begin(), level.end());
  for (std::size_t f = 0; f < out.size(); ++f)
    if (health.lamp_silent(f))
      out[f] = full ? max_of(f) : 0;
    else if (!full && health.lamp_failing(f))  // it obeys, but its lamp may be out
      out[f] = 0;
  return out;
}

bool ShowController::State::any_lamp_lost() const {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (health.lamp_silent(f) || health.lamp_failing(f)) return true;
  return false;
}

double ShowController::State::in_doubt_for_lost_lamps_lx(std::size_t point, std::span<const double> level) const {
  if (!any_lamp_lost()) return 0;
  const double lux = predicted.at_point(estimator, point, level).lux;
  return std::max(lux - predicted.at_point(estimator, point, with_lost_lamps_at(level, false)).lux,
                  predicted.at_point(estimator, point, with_lost_lamps_at(level, true)).lux - lux);
}

bool ShowController::State::seen_by_a_meter(std::size_t fixture, std::span<const double> level) const {
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (!readings.measured()[i] || health.meter_lost(i)) continue;
    const Prediction there = predicted.at_meter(estimator, i, level);
    const double its_lx = level[fixture] * estimator.lux_per_level_at_meter(i, fixture).lux;
    if (its_lx >= kSurelySeen * GainEstimator::smallest_jump_lx(there)) return true;
  }
  return false;
}

bool ShowController::State::calibration_saw(std::size_t fixture, Time now) const {
  const std::optional<LightError>& known_to = rig.fixtures[fixture].known_to;
  if (!known_to || !(known_to->output < kSawItBurn)) return false;
  const double since_opened_s = rig_since ? to_seconds(now - *rig_since) : 0;
  return rig.calibrated_hours_ago + since_opened_s / 3600 < kBurnsOn_h;
}

std::optional<std::size_t> ShowController::State::unseen_lamp_for(std::size_t point, std::span<const double> level,
                                                                  Time now, const LuxEstimate& light,
                                                                  double allowed_lx) const {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (level[f] <= 0 || tells_of_lamp[f] != 0 || calibration_saw(f, now)) continue;
    const LuxEstimate without{light.lux - level[f] * estimator.lux_per_level(point, f), light.half_width_lx};
    if (verdict_of(without, *points_in_force[point].goal_lx, allowed_lx) != Verdict::met && !seen_by_a_meter(f, level))
      return f;
  }
  return std::nullopt;
}

LuxEstimate ShowController::State::light_by_model(std::size_t point, std::span<const double> level,
                                                  const Prediction& prediction) const {
  LuxEstimate light = estimate_of(prediction.lux, prediction.standard_error_lx);
  light.half_width_lx = std::hypot(light.half_width_lx, estimator.common_tolerance() * prediction.lux);
  light.half_width_lx += in_doubt_for_lost_lamps_lx(point, level);
  return light;
}

PointStatus ShowController::State::point_status(std::size_t p, std::span<const double> level, Time now) const {
  PointStatus status;
  status.goal_lx = points_in_force[p].goal_lx;
  const Prediction prediction = predicted.at_point(estimator, p, level);
  status.predicted_lx = prediction.lux;
  // What a meter teaches is off by what the meter is off by.
  const double tolerance =
      estimator.confirmed(p) ? rig.luxmeters[*meter_at(p)].tolerance : estimator.common_tolerance();
  status.standard_error_lx = std::hypot(prediction.standard_error_lx, tolerance * prediction.lux / std::sqrt(3.0));
  if (const auto meter = meter_at(p); meter && !health.meter_lost(*meter)) {
    const bool settled = !program.blackout && program.done(now);
    const std::optional<LuxReading>& measured = readings.measured()[*meter];
    const bool has_sample = settled && measured && measured->taken >= program.start;
    if (const auto& reading = has_sample ? measured : readings.believed()[*meter]) {
      status.measured_lx = reading->lux;
      status.measured_at = reading->taken;
    }
  }
  if (p < progress.why.size()) status.why = progress.why[p];
  if (status.measured_lx) {
    const Luxmeter& meter = rig.luxmeters[*meter_at(p)];
    status.light = estimate_of_reading(*status.measured_lx, GainEstimator::kRepeatability, meter.tolerance,
                                       meter.patch.lux_per_count);
  } else {
    status.light = light_by_model(p, level, prediction);
  }
  // It is not known which of them is right: the light may be higher or lower by this much.
  const ScaleWatch::Doubt doubt = scale.doubt_at(meter_at(p), readings.measured());
  status.light.half_width_lx += status.light.lux * (std::exp(std::abs(doubt.log_share)) - 1);
  judge_goal(p, level, now, status);
  judge_limit(p, level, now, status);
  return status;
}

bool ShowController::State::reads_otherwise_now(std::size_t point, const PointStatus& status) const {
  const std::optional<LuxReading>& heard = readings.heard()[*meter_at(point)];
  return heard && heard->taken > status.measured_at &&
         std::abs(heard->lux - *status.measured_lx) > GainEstimator::smallest_jump_lx({*status.measured_lx, 0});
}

void ShowController::State::judge_goal(std::size_t p, std::span<const double> level, Time now,
                                       PointStatus& status) const {
  if (!status.goal_lx) return;
  double largest_goal_lx = *status.goal_lx;
  if (largest_goal_lx == 0)
    for (const Point& point : points_in_force) largest_goal_lx = std::max(largest_goal_lx, point.goal_lx.value_or(0));
  const double allowed_lx = tolerance_lx(*status.goal_lx, rig.goal_tolerance(p), largest_goal_lx);
  status.verdict = verdict_of(status.light, *status.goal_lx, allowed_lx);
  // The meter at the point contradicts the model: it is not known which of them is right.
  if (const auto meter = meter_at(p); meter && health.meter_implausible(*meter) && status.verdict == Verdict::met)
    status.verdict = Verdict::unknown;
  // It has read something else since: the light changes, or it will not be believed. The next sample tells.
  const bool changing = status.measured_lx && status.verdict == Verdict::met && reads_otherwise_now(p, status);
  if (changing) status.verdict = Verdict::unknown;
  std::optional<std::size_t> unseen;
  if (!status.measured_lx && status.verdict == Verdict::met)
    unseen = unseen_lamp_for(p, level, now, status.light, allowed_lx);
  if (unseen) status.verdict = Verdict::unknown;
  const std::string state = why_not_the_plan(phase, program.blackout);
  std::string settles;
  if (const ScaleWatch::Doubt doubt = scale.doubt_at(meter_at(p), readings.measured()); !doubt.reason.empty()) {
    settles = doubt.reason;
  } else if (unseen) {
    settles = fmt::format(
        "nobody sees whether fixture \"{}\" burns; a luxmeter in its light would settle it, or a calibration",
        rig.fixtures[*unseen].name);
  } else if (changing) {
    settles = fmt::format("luxmeter \"{}\" reads {:.4g} lx by now; its next sample will settle it",
                          rig.luxmeters[*meter_at(p)].name, readings.heard()[*meter_at(p)]->lux);
  } else if (const auto meter = meter_at(p); meter && bypassed.meter(*meter)) {
    settles = fmt::format("luxmeter \"{}\" is bypassed; put it right", rig.luxmeters[*meter].name);
  } else if (status.measured_lx) {
    settles = fmt::format(
        "luxmeter \"{}\" is good to ± {:.3g} %; one that is better would settle it, or a wider goal_tolerance",
        rig.luxmeters[*meter].name, 100 * rig.luxmeters[*meter].tolerance);
  } else if (meter) {
    settles = fmt::format("luxmeter \"{}\" is lost or not believed; put it right", rig.luxmeters[*meter].name);
  } else {
    const bool for_lost_lamps = 2 * in_doubt_for_lost_lamps_lx(p, level) > status.light.half_width_lx;
    for (std::size_t f = 0; for_lost_lamps && f < level.size() && settles.empty(); ++f)
      if (health.lamp_silent(f) || health.lamp_failing(f))
        settles = fmt::format("fixture \"{}\" {}; put it right", rig.fixtures[f].name,
                              health.lamp_silent(f) ? "does not answer" : "says that something is wrong with it");
    if (settles.empty()) settles = "by the model; a luxmeter here would settle it";
  }
  status.reason = reason_of(*status.verdict, status.light, *status.goal_lx, allowed_lx,
                            state.empty() ? status.why : state, settles);
}

/// Outputs are scaled so that limits hold in the worst case of what is believed (OutputProgram). Two things can
/// contradict that: light that is not ours (a desk drives the lamps itself, or a lamp does not answer), and a reading.
/// A reading that is not believed counts, too, since the cause is not known.
void ShowController::State::judge_limit(std::size_t p, std::span<const double> level, Time now,
                                        PointStatus& status) const {
  if (!points_in_force[p].max_lx) return;
  const double max_lx = *points_in_force[p].max_lx;
  const auto say = [&](LimitVerdict verdict, std::string reason) {
    status.limit = verdict;
    status.limit_reason = std::move(reason);
  };
  const auto meter = meter_at(p);
  const std::optional<LuxReading> heard = meter ? readings.heard()[*meter] : std::nullopt;
  const double tolerance = meter ? rig.luxmeters[*meter].tolerance : 0;
  if (status.measured_lx && *status.measured_lx > max_lx * (1 + tolerance))
    return say(LimitVerdict::exceeded, fmt::format("luxmeter \"{}\" reads {:.1f} lx, the limit is {:g} lx",
                                                   rig.luxmeters[*meter].name, *status.measured_lx, max_lx));
  if (meter && !bypassed.meter(*meter) && !status.measured_lx && heard && heard->lux > max_lx * (1 + tolerance))
    return say(
        LimitVerdict::unknown,
        fmt::format("luxmeter \"{}\" read {:.1f} lx last, over the limit of {:g} lx, and is lost or not believed; "
                    "measure by hand",
                    rig.luxmeters[*meter].name, heard->lux, max_lx));
  const auto breach = std::find_if(progress.breaches.begin(), progress.breaches.end(),
                                   [&](const LimitBreach& one) { return one.point == p; });
  if (breach != progress.breaches.end())
    return say(LimitVerdict::unknown,
               fmt::format("with its luxmeter's tolerance it may have {:.1f} lx, the limit is {:g} lx; look for light "
                           "that is not the rig's",
                           breach->worst_case_lx, max_lx));
  if (const ScaleWatch::Doubt doubt = scale.doubt_at(meter_at(p), readings.measured());
      status.measured_lx && doubt.log_share < 0 && *status.measured_lx * std::exp(-doubt.log_share) > max_lx)
    return say(LimitVerdict::unknown,
               fmt::format("it may have {:.1f} lx, the limit is {:g} lx: {}",
                           *status.measured_lx * std::exp(-doubt.log_share), max_lx, doubt.reason));
  if (status.measured_lx) return say(LimitVerdict::kept, "");
  const bool driven_by_desk =
      std::any_of(program.desks.begin(), program.desks.end(), [](const DeskBlend& desk) { return desk.silent; });
  if (driven_by_desk || any_lamp_lost()) {
    const double worst_case_lx = estimator.max_lux_as_given(p, with_lost_lamps_at(level, true), now);
    const char* whose = driven_by_desk ? "a desk drives lamps that light it" : "a lamp that lights it does not answer";
    if (status.light.lux - status.light.half_width_lx > max_lx)
      return say(LimitVerdict::exceeded,
                 fmt::format("{}: {:.1f} lx by the model, the limit is {:g} lx", whose, status.light.lux, max_lx));
    if (worst_case_lx > max_lx)
      return say(LimitVerdict::unknown, fmt::format("{}: it may have {:.1f} lx, the limit is {:g} lx; measure by hand",
                                                    whose, worst_case_lx, max_lx));
  }
  say(LimitVerdict::kept, "");
}

}  // namespace luxrig
