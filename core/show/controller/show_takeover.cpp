/// Takes over light from another sender: the guardian of a daemon that died.

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/show/controller/show_state.h"

namespace luxrig {

void ShowController::go_on_from(Time now, const LightInForce& light) {
  State& state = *state_;
  now = state.at_least_last(now);
  const std::size_t count = state.rig.fixtures.size();
  const std::vector<Joints>& joints = light.look.joints;
  LUXRIG_CHECK(light.look.levels.size() == count && light.safe_levels.size() == count && joints.size() == count,
               "light of another rig");
  std::vector<double> level = light.look.levels, safe = light.safe_levels;
  bool all_known = true;
  for (std::size_t f = 0; f < count; ++f) {
    const Fixture& fixture = state.rig.fixtures[f];
    if (!fixture.moves) continue;
    state.program.joints[f] = joints[f];
    if (!fixture.axes) continue;
    all_known = false;
    level[f] = safe[f] = 0;
  }
  state.turned = all_known;
  state.sharing.have_light(state.program, now, light.silent);
  state.in_force = level;
  state.fade(now + from_seconds(light.hold_s), std::move(level), std::move(safe), light.fade_s,
             state.rig.control.fade_curve);
}

void ShowController::take_back(Time now, std::span<const double> level) {
  State& state = *state_;
  now = state.at_least_last(now);
  LUXRIG_CHECK(level.size() == state.rig.fixtures.size(), "light of another rig");
  if (state.phase == Phase::idle) return;
  const Phase before = state.phase;
  state.in_force.assign(level.begin(), level.end());
  state.fade(now, state.in_force, state.in_force, 0, FadeCurve::linear);
  if (before == Phase::frozen) return;
  if (before == Phase::safe || before == Phase::safe_fading || !state.cue) return state.fade_to_safe(now);
  state.resume(now);
}

}  // namespace luxrig
