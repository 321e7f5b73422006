/// Effects on the show of lighting desks that share control of the light.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/output/dimming.h"
#include "core/rig/housing.h"
#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

/// From the last blink back to the light before.
constexpr Duration kIdentifyFade = std::chrono::milliseconds(500);

}  // namespace

/// Sets limits for levels that were not computed, and which heads a desk cannot light while they turn.
void ShowController::State::guard_against_desks(Time now) {
  if (sharing.empty()) return;
  const bool limited = std::any_of(points_in_force.begin(), points_in_force.end(),
                                   [](const Point& point) { return point.max_lx.has_value(); });
  WorstCase worst = estimator.worst_of_any(now, turned_heads.turned());
  program.any_lux_per_level = std::move(worst.worst_lux_per_level);
  program.any_max_lx = std::move(worst.max_lx);
  if (rig.limits.max_watts) {
    // The program's last row is that of power; it holds for any levels.
    const Eigen::Index row = program.any_max_lx.size();
    program.any_lux_per_level.conservativeResize(row + 1, static_cast<Eigen::Index>(rig.fixtures.size()));
    program.any_max_lx.conservativeResize(row + 1);
    program.any_lux_per_level.row(row) = program.worst_lux_per_level.row(program.worst_lux_per_level.rows() - 1);
    program.any_max_lx[row] = *rig.limits.max_watts;
  }
  program.limits_released = from_seconds(rig.control.fade_s);
  program.turned = turned_heads.turned();
  program.turned_until = turned_heads.home_at();
  program.heads_arrive = turned ? arrive : Time::max();
  program.heads_guarded.assign(rig.fixtures.size(), 0);
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) program.heads_guarded[f] = limited && rig.fixtures[f].moves;
}

/// A first look that came on while listening would skip its fade and stages when no desk is heard.
bool ShowController::State::waits_for_desks(Time now) {
  return phase == Phase::idle && in_force.empty() && sharing.listens_still(now);
}

void ShowController::State::begin_after_listening(Time now) {
  if (!cue || waits_for_desks(now)) return;
  if (turned) {  // heads have not got their aim either
    turned = false;
    first_turn(now, awaited ? awaited->look.joints : program.joints);
  }
  start_cue(now, *cue);
}

void ShowController::State::step_desks(Time now) {
  if (turned_heads.step(now, program, health)) {
    guard_against_desks(now);
    ++program.revision;
  }
  const SharedControl::Change shared = sharing.step(program, now, turned_heads.away(now));
  if (shared.is) progress.converged = false;
  // Readings under a desk's control are not believed, and limits are still being released.
  if (shared.was && !shared.is) {
    faults.light_changes(std::max(now + program.limits_released, program.start + program.duration));
    readings.restart(std::max(now + program.limits_released, program.start + program.duration) +
                     from_seconds(rig.control.settle_s));
  }
}

DeskFollowerSettings ShowController::State::desk_settings(const DeskRules& rules,
                                                          const std::vector<std::size_t>& fixtures) const {
  DeskFollowerSettings settings;
  settings.rules = rules;
  settings.fixtures = fixtures;
  for (const std::size_t f : fixtures) {
    LUXRIG_CHECK(f < rig.fixtures.size(), "fixture {} of {}", f, rig.fixtures.size());
    settings.dimmer_curve.push_back(rig.fixtures[f].dimmer_curve);
    settings.measured_curve.push_back(rig.fixtures[f].measured_curve);
    settings.joints.push_back(program.joints[f]);
  }
  settings.desk_may_turn = std::none_of(points_in_force.begin(), points_in_force.end(),
                                        [](const Point& point) { return point.max_lx.has_value(); });
  settings.fade = from_seconds(rig.control.fade_s);
  settings.curve = rig.control.fade_curve;
  return settings;
}

Result<void> ShowController::State::identify(Time now, std::size_t fixture, Duration how_long) {
  LUXRIG_CHECK(fixture < rig.fixtures.size(), "fixture {} of {}", fixture, rig.fixtures.size());
  if (how_long <= Duration::zero()) return refusal("for no time at all nobody would see it: give a time above 0");
  if (program.blackout) return refusal("a blackout lies over everything: lift it first");
  if (phase == Phase::idle) return refusal("nothing is lit yet: apply a plan first");
  const std::vector<std::size_t> fixtures = housing_of(rig, fixture);
  if (parked(fixture)) return refusal("it is parked: apply a plan first");
  std::vector<Joints> looks(rig.fixtures.size());
  program.joints_at(now, looks);
  const KeepOutZones& zones = head_guard.zones();
  if (const auto zone = zones.met(fixture, looks[fixture]))
    return refusal(fmt::format("it looks into keep-out zone \"{}\": turn it elsewhere first", zones.name(*zone)));
  if (sharing.prolong(now, fixtures, now + how_long)) return {};
  DeskFollowerSettings settings = desk_settings({DeskMode::takeover, HandBack::at_once}, fixtures);
  settings.fade = std::min(settings.fade, kIdentifyFade);
  std::vector<double> level(rig.fixtures.size());
  std::vector<Joints> joints(rig.fixtures.size());
  program.levels_at(now, level);
  program.joints_at(now, joints);
  // A head that would nod into a zone blinks instead.
  IdentifyPattern nods(rig, fixtures, level, joints, settings.desk_may_turn, now, how_long);
  settings.desk_may_turn = settings.desk_may_turn && !zones.may_meet(fixture, nods.nodding());
  IdentifyPattern pattern(rig, fixtures, level, joints, settings.desk_may_turn, now, how_long);
  sharing.identify(program, now, std::move(settings), std::move(pattern));
  guard_against_desks(now);
  return {};
}

Result<void> ShowController::State::aim(Time now, std::size_t fixture, const Joints& joints, double level,
                                        Duration how_long) {
  LUXRIG_CHECK(fixture < rig.fixtures.size(), "fixture {} of {}", fixture, rig.fixtures.size());
  const Fixture& head = rig.fixtures[fixture];
  const auto within = [](double angle, double least, double most) { return angle >= least && angle <= most; };
  if (!head.moves) return refusal("it has no pan and tilt");
  if (how_long <= Duration::zero() || !(level >= 0 && level <= 1))
    return refusal("give a level of 0 to 1 and a time above 0");
  if (!within(joints.pan_rad, head.range.pan_min_rad, head.range.pan_max_rad) ||
      !within(joints.tilt_rad, head.range.tilt_min_rad, head.range.tilt_max_rad) ||
      (head.range.zooms() && !within(joints.beam_rad, head.range.beam_min_rad, head.range.beam_max_rad)))
    return refusal("that is outside its range");
  if (program.blackout) return refusal("a blackout lies over everything: lift it first");
  if (phase == Phase::idle) return refusal("nothing is lit yet: apply a plan first");
  if (parked(fixture)) return refusal("it is parked: apply a plan first");
  if (const auto zone = head_guard.zones().met(fixture, joints))
    return refusal(fmt::format("it would look into keep-out zone \"{}\"", head_guard.zones().name(*zone)));
  const std::vector<std::size_t> fixtures = housing_of(rig, fixture);
  DeskFollowerSettings settings = desk_settings({DeskMode::takeover, HandBack::at_once}, fixtures);
  if (!settings.desk_may_turn) {
    if (!estimator.tells_of_any_aim())
      return refusal("points of this rig have limits, and what it gives there is not known");
    settings.desk_may_turn = true;
    turned_heads.turn(rig, now, fixtures);
  }
  settings.fade = std::min(settings.fade, kIdentifyFade);
  std::vector<double> drive;
  for (const std::size_t f : fixtures)
    drive.push_back(drive_for(rig.fixtures[f], std::min(level, program.max_level[f])));
  sharing.identify(program, now, std::move(settings),
                   IdentifyPattern(fixtures, std::move(drive), joints, now, how_long));
  guard_against_desks(now);
  return {};
}

std::size_t ShowController::add_desk(const DeskRules& rules, const DeskPart& part) {
  State& state = *state_;
  const std::size_t desk = state.sharing.add(state.program, state.desk_settings(rules, part.fixtures), part.name);
  state.guard_against_desks(state.last);
  return desk;
}

void ShowController::desk(Time now, std::size_t index, const DeskFrame& frame) {
  now = state_->at_least_last(now);
  state_->sharing.hear(state_->program, now, index, frame);
}

Result<void> ShowController::identify(Time now, std::size_t fixture, Duration how_long) {
  now = state_->at_least_last(now);
  return state_->identify(now, fixture, how_long);
}

Result<void> ShowController::aim(Time now, std::size_t fixture, const Joints& joints, double level, Duration how_long) {
  now = state_->at_least_last(now);
  return state_->aim(now, fixture, joints, level, how_long);
}

void ShowController::hand_back(Time now) {
  now = state_->at_least_last(now);
  state_->sharing.hand_back(state_->program, now);
}

}  // namespace luxrig
