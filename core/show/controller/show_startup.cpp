/// Light that comes on by stages: the first time, and when power comes back.

#include <algorithm>
#include <utility>

#include "core/show/controller/show_state.h"

namespace luxrig {

bool ShowController::State::start_lamps(Time now, const std::vector<double>& present,
                                        const std::vector<double>& levels) {
  if (std::exchange(power_came, true) || !staged(rig.startup)) return false;
  std::vector<double> from = levels, burning(rig.fixtures.size(), 0.0);
  bool any_dark = false;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    any_dark = any_dark || (present[f] <= 0 && levels[f] > 0);
    if (present[f] <= 0 || program.max_level[f] <= 0) continue;
    burning[f] = present[f] / program.max_level[f];
    from[f] = std::max(from[f], present[f]);
  }
  // All of them were lit before by another sender: this look fades in as usual.
  if (!any_dark && !in_force.empty()) return false;
  const std::vector<std::uint8_t> all(rig.fixtures.size(), 1);
  program.lamp_starts = luxrig::lamp_starts(rig, program.max_level, all, now, arrive, burning);
  // The ceilings do the fading: a fade below them would add watts to theirs.
  const Time begin = std::max(now, arrive);
  fade(now, std::move(from), levels, to_seconds(std::max(Duration{}, all_up(program.lamp_starts) - begin)),
       FadeCurve::linear);
  return true;
}

void ShowController::State::watch_power(Time now) {
  if (!rig.startup.after_loss || !power_came) return;
  std::vector<std::uint8_t> back(rig.fixtures.size(), 0);
  bool any = false;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const bool is = health.lamp_lost(f);
    const bool was = std::exchange(powerless[f], is ? std::uint8_t{1} : std::uint8_t{0}) != 0;
    back[f] = was && !is;
    any = any || was != is;
    if (!is) continue;
    if (program.lamp_starts.empty()) program.lamp_starts.resize(rig.fixtures.size());
    program.lamp_starts[f] = {kWithoutPower, Duration{}};
  }
  if (!any) return;
  if (program.lamp_starts.empty()) program.lamp_starts.resize(rig.fixtures.size());
  const LampStarts anew =
      luxrig::lamp_starts(rig, program.max_level, back, now, std::max(now, all_up(program.lamp_starts)));
  for (std::size_t f = 0; f < back.size(); ++f) {
    if (back[f] != 0) program.lamp_starts[f] = anew[f];
  }
  ++program.revision;
}

}  // namespace luxrig
