// The status for a person, and the judgements that the state machine shares with it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/output/dimming.h"
#include "core/show/controller/show_state.h"

namespace luxrig {

std::vector<double> ShowController::State::safe_levels() const {
  std::vector<double> level;
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    const std::size_t bus = rig.fixtures[i].bus;
    const double of_bus = (bus < rig.buses.size() ? rig.buses[bus].safe_level : std::nullopt).value_or(rig.safe.level);
    const double wanted = rig.fixtures[i].safe_level.value_or(of_bus);
    const double most = bypassed.lamp(i) ? 0 : program.max_level[i];
    level.push_back(std::clamp(rig.fixtures[i].switched ? switched_level(wanted) : wanted, 0.0, most));
  }
  // Who holds a lamp low may be working on it.
  for (const ByHand& held : hands.all())
    if (held.what == ByHand::What::level) level[held.index] = std::min(level[held.index], held.value);
  return level;
}

std::vector<double> ShowController::State::limited_safe_levels(Time now) const {
  const std::vector<double> wanted = safe_levels();
  std::vector<double> level = estimator.within_limits(wanted, now);
  if (!lost.any()) return level;
  // A lamp that comes back gets its level at once.
  GainEstimator all_answer = estimator;
  all_answer.set_lost({}, watched);
  const std::vector<double> answering = all_answer.within_limits(wanted, now);
  for (std::size_t i = 0; i < level.size(); ++i) level[i] = std::min(level[i], answering[i]);
  return level;
}

std::optional<std::size_t> ShowController::State::meter_at(std::size_t point) const {
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (rig.luxmeters[i].point == point) return i;
  }
  return std::nullopt;
}

double ShowController::State::possible_gain(const Correction& correction) const {
  double most = 0;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    const std::optional<std::size_t> point = rig.luxmeters[i].point;
    const std::optional<LuxReading>& measured = readings.measured()[i];
    if (!point || !measured) continue;
    const double goal_lx = points_in_force[*point].goal_lx.value_or(0);
    if (goal_lx > 0) most = std::max(most, std::abs(correction.aimed_lx[*point] - measured->lux) / goal_lx);
  }
  return most;
}

double ShowController::State::known_gain(const Correction& correction) const {
  double most = 0;
  for (const Luxmeter& meter : rig.luxmeters) {
    const double goal_lx = meter.point ? points_in_force[*meter.point].goal_lx.value_or(0) : 0;
    if (goal_lx > 0)
      most = std::max(most, std::abs(correction.aimed_lx[*meter.point] - correction.now_lx[*meter.point]) / goal_lx);
  }
  return most;
}

bool ShowController::State::arrived(std::size_t point, double lux) const {
  if (!points_in_force[point].goal_lx) return true;
  const double goal_lx = *points_in_force[point].goal_lx;
  const double near_lx = std::max(kArrivedTolerance, rig.control.tolerance) * goal_lx;
  if (std::abs(lux - goal_lx) <= near_lx) return true;
  return point < progress.why.size() && !progress.why[point].empty() &&
         std::abs(lux - progress.aimed_lx[point]) <= near_lx;
}

bool ShowController::State::all_metered_goals_arrived() const {
  if (!progress.breaches.empty()) return false;
  bool any = false;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    const std::optional<std::size_t> point = rig.luxmeters[i].point;
    if (!point || !points_in_force[*point].goal_lx) continue;
    const std::optional<LuxReading>& measured = readings.measured()[i];
    if (!measured || !arrived(*point, measured->lux)) return false;
    any = true;
  }
  return any;
}

std::string ShowController::State::detail(Time now, const VerdictCounts& goals) const {
  const auto remaining = [&](Duration whole) { return std::max(0.0, to_seconds(phase_since + whole - now)); };
  std::string text;
  switch (phase) {
    case Phase::idle:
      text = cue                ? "the plan waits until it is known whether a desk has the light"
             : in_force.empty() ? "no plan applied yet"
                                : "the light is as it was; no plan applied yet";
      break;
    case Phase::moving:
      text = "heads go dark before they turn";
      break;
    case Phase::fading:
      text =
          now >= program.start && now < all_up(program.lamp_starts)
              ? fmt::format("lamps come on by stages, all in {:.1f} s", to_seconds(all_up(program.lamp_starts) - now))
          : now < program.start ? fmt::format("heads turn, light in {:.1f} s", to_seconds(program.start - now))
                                : std::string("fading to the plan");
      break;
    case Phase::settling:
      text = "waiting for lamps and meters to settle";
      break;
    case Phase::measuring:
      text = "measuring";
      break;
    case Phase::correcting:
      text = fmt::format("correcting, round {}", progress.round);
      break;
    case Phase::holding: {
      text = text_of(goals);
      if (health.any_meter_lost()) text += "; lost luxmeters correct nothing";
      if (lost.any())
        text += fmt::format("; {} of {} fixtures are lost, the rest goes on", lost.count(), rig.fixtures.size());
      break;
    }
    case Phase::frozen:
      text = failing ? fmt::format("light held, safe look in {:.1f} s: {}", remaining(from_seconds(rig.safe.hold_s)),
                                   failure)
                     : "light held; everything is back, going on in a moment";
      break;
    case Phase::safe_fading:
    case Phase::safe:
      text = phase == Phase::safe ? "safe look" : "fading to the safe look";
      text += asked_safe ? ", as asked" : failing ? ": " + failure : "; everything is back, going on in a moment";
      if (failing && !asked_safe && only_model_is_off())
        text += "; if the luxmeters are right and the rig file is not, luxrig calibrate measures the rig from here";
      break;
  }
  if (sharing.shared()) text = sharing.who(rig, program, now) + "; the plan: " + text;
  return program.blackout ? "blackout (" + text + ")" : text;
}

ShowStatus ShowController::State::status(Time now) const {
  ShowStatus status;
  status.phase = phase;
  status.phase_since = phase_since;
  status.round = progress.round;
  status.converged = progress.converged && !program.blackout;
  status.blackout = program.blackout;
  status.may_be_measured = failing && only_model_is_off() && !asked_safe && phase == Phase::safe && safe_is_read;
  status.plan_waits = awaited.has_value();

  const std::vector<double> level = levels_out(now);
  std::vector<Joints> joints(rig.fixtures.size());
  program.joints_at(now, joints);
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    const bool as_planned = i < planned.aim_world_m.size() && same_aim(joints[i], planned.joints[i]);
    status.fixtures.push_back({joints[i], as_planned ? planned.aim_world_m[i] : std::nullopt, level[i],
                               drive_for(rig.fixtures[i], level[i]), program.to_level[i],
                               !health.lamp_silent(i), estimator.gain(i), estimator.gain_standard_error(i)});
  }
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    status.fixtures[f].parked = parked(f) || (!parking.empty() && parking[f] != 0);
    if (status.fixtures[f].parked) status.fixtures[f].waits_for = "the next plan";
  }
  if (dipped) status.fixtures[dipped->fixture].dipped = true;
  status.resting = !program.parked.empty() && parking.empty() && now >= arrive;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    status.points.push_back(point_status(p, level, now));
    const PointStatus& point = status.points.back();
    if (point.verdict) status.goals.add(*point.verdict);
    if (!point.limit) continue;
    ++(*point.limit == LimitVerdict::kept       ? status.limits_kept
       : *point.limit == LimitVerdict::exceeded ? status.limits_exceeded
                                                : status.limits_unknown);
  }
  status.detail = detail(now, status.goals);
  status.luxmeters = readings.believed();
  status.shown = readings.heard();
  status.alarms = health.alarms();
  for (const LimitBreach& breach : progress.breaches) {
    const Point& point = points_in_force[breach.point];
    status.alarms.push_back(
        {true, rig.luxmeters[*meter_at(breach.point)].name,
         fmt::format("point \"{}\" may have {:.1f} lx by its meter, its limit is {:.1f} lx; the fixtures that light it "
                     "are being dimmed; look for light that is not the rig's",
                     point.name, breach.worst_case_lx, *point.max_lx),
         breach.since});
  }
  if (measured_beyond) status.alarms.push_back(*measured_beyond);
  status.by_hand = hands.all();
  for (ByHand& held : status.by_hand) held.why = why_not(now, held);
  tell_losses(status);
  tell_bypassed(status);
  scale.tell(status, readings.measured());
  faults.tell(status);
  head_guard.tell(status, rig, program, sharing.shared());
  sharing.tell(status, now);
  return status;
}

}  // namespace luxrig
