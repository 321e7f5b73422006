/// Parked heads: dark, at their rest position.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/output/head_travel.h"
#include "core/rig/housing.h"
#include "core/show/controller/show_state.h"

namespace luxrig {

void ShowController::State::first_turn(Time now, std::span<const Joints> joints) {
  if (std::exchange(turned, true)) return;
  double wait_s = 0;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (const Fixture& fixture = rig.fixtures[f]; fixture.moves)
      wait_s = std::max(wait_s, fixture.reset_s + travel_s(fixture, std::nullopt, joints[f]) + head_delay_s(fixture));
  arrive = now + from_seconds(wait_s);
}

Result<void> ShowController::State::park(Time now, std::span<const std::size_t> fixtures) {
  if (asked_safe) return refusal("the show has ended in its safe look: apply a plan first");
  std::vector<std::uint8_t> chosen(rig.fixtures.size(), 0);
  for (const std::size_t named : fixtures) {
    LUXRIG_CHECK(named < rig.fixtures.size(), "fixture {} of {}", named, rig.fixtures.size());
    if (!rig.fixtures[named].park)
      return refusal(
          fmt::format("{} has no place to rest: give it park_pan_deg and park_tilt_deg", rig.fixtures[named].name));
    for (const std::size_t f : housing_of(rig, named)) chosen[f] = 1;
  }
  if (fixtures.empty())
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) chosen[f] = rig.fixtures[f].park.has_value();
  if (std::find(chosen.begin(), chosen.end(), 1) == chosen.end())
    return refusal("no head has a place to rest: give one park_pan_deg and park_tilt_deg");
  // A look that still waits for heads to go dark is taken with this one.
  Awaited next = awaited ? std::move(*awaited) : Awaited{planned, {}, {}};
  Look& look = next.look;
  if (!awaited) look.joints = program.joints;
  std::vector<double> levels = cue ? *cue : std::vector<double>(rig.fixtures.size(), 0.0);
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (chosen[f] == 0 && !parked(f)) continue;
    chosen[f] = 1;
    look.joints[f] = *rig.fixtures[f].park;
    if (!look.aim_world_m.empty()) look.aim_world_m[f].reset();
    levels[f] = 0;
  }
  parking = std::move(chosen);
  first_turn(now, look.joints);
  if (phase == Phase::idle && !cue && in_force.empty()) {  // nothing is lit, and no light is due
    program.joints = std::move(look.joints);
    finish_parking();
    const std::vector<double> dark(rig.fixtures.size(), 0.0);
    fade(now, dark, dark, 0, FadeCurve::linear);
    return {};
  }
  awaited = std::move(next);
  start_cue(now, std::move(levels));
  return {};
}

/// The heads are dark: from now on nothing lights or turns them.
void ShowController::State::finish_parking() {
  if (parking.empty()) return;
  program.parked = std::exchange(parking, {});
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (program.parked[f] == 0) continue;
    program.max_level[f] = 0;
    estimator.set_max_level(f, 0);
  }
}

void ShowController::State::unpark() {
  parking.clear();
  for (std::size_t f = 0; f < program.parked.size(); ++f) {
    if (program.parked[f] == 0) continue;
    program.parked[f] = 0;
    if (bypassed.lamp(f)) continue;
    program.max_level[f] = max_of(f);
    estimator.set_max_level(f, program.max_level[f]);
  }
  program.parked.clear();
}

Result<void> ShowController::park(Time now, std::span<const std::size_t> fixtures) {
  now = state_->at_least_last(now);
  return state_->park(now, fixtures);
}

}  // namespace luxrig
