/// Light held to be measured, where luxmeters show what the model does not allow (`on_meter_loss`): the model is what is
/// to be measured then. Limits hold by what the meters show, too.

#include <fmt/format.h>

#include <algorithm>

#include "core/show/controller/show_state.h"

namespace luxrig {

bool ShowController::State::only_model_is_off() const {
  return rig.safe.on_meter_loss && !too_much_lost() && health.any_meter_lost() && !health.any_meter_gone();
}

bool ShowController::State::all_lamps_held() const {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (!hands.level(f) && !bypassed.lamp(f)) return false;
  return true;
}

Result<void> ShowController::State::may_measure(std::span<const ByHand> wanted) const {
  std::vector<std::uint8_t> held(rig.fixtures.size(), 0);
  for (const ByHand& one : wanted)
    if (one.what == ByHand::What::level) held[one.index] = 1;
  for (std::size_t f = 0; f < held.size(); ++f)
    if (held[f] == 0 && !hands.level(f) && !bypassed.lamp(f))
      return refusal(fmt::format("\"{}\" is not held: light is measured with every lamp held", rig.fixtures[f].name));
  const bool safe = phase == Phase::frozen || phase == Phase::safe_fading || phase == Phase::safe;
  if (safe && failing && !only_model_is_off())
    return refusal("the rig is in its safe look, and not only since its model is off: " + failure +
                   "; mend that, then measure");
  if (safe && failing && !safe_is_read)
    return refusal("the luxmeters have not been read under the safe look yet: try again in some seconds");
  return {};
}

/// A reading above its point's limit counts at once, believed or not.
void ShowController::State::watch_measuring(Time now) {
  if (!measuring) return;
  measuring = all_lamps_held();
  if (!measuring || !only_model_is_off()) return;
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    const std::optional<std::size_t> point = rig.luxmeters[m].point;
    const std::optional<LuxReading>& shown = readings.heard()[m];
    if (!point || !points_in_force[*point].max_lx || !shown || shown->taken < program.start) continue;
    const double max_lx = *points_in_force[*point].max_lx;
    if (shown->lux <= max_lx * (1 + rig.luxmeters[m].tolerance)) continue;
    measuring = false;
    // Measured again, it is dimmed by so much.
    const double worst_lx = estimator.max_lux_at_point(*point, program.to_level, now);
    if (worst_lx > 0) beyond_model = std::max(beyond_model, shown->lux / worst_lx);
    measured_beyond =
        Alarm{true, rig.luxmeters[m].name,
              fmt::format("it showed {:.4g} lx while the rig was measured, and \"{}\" may have {:.4g} lx: "
                          "the rig went to its safe look; look for light that is not the rig's, then "
                          "measure again",
                          shown->lux, rig.points[*point].name, max_lx),
              now};
    return fade_to_safe(now);
  }
}

/// Of a limited point, by what its limit goes by; elsewhere by the most that is believed of the meter.
void ShowController::State::see_beyond_model(Time now, const Judgement& judgement) {
  const std::size_t m = judgement.luxmeter;
  safe_is_read = safe_is_read || phase == Phase::safe;
  const std::optional<std::size_t> point = rig.luxmeters[m].point;
  const bool limited = point && points_in_force[*point].max_lx;
  const double most_lx = limited ? estimator.max_lux_at_point(*point, program.to_level, now) : judgement.highest_lx;
  const double shown_lx = readings.sample(m).lux * (1 + rig.luxmeters[m].tolerance);
  if (most_lx > 0) beyond_model = std::max(beyond_model, shown_lx / most_lx);
}

void ShowController::State::keep_measured_limits(Time now, std::vector<double>& level) const {
  double share = 1;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!points_in_force[p].max_lx) continue;
    const double worst_lx = beyond_model * estimator.max_lux_at_point(p, level, now);
    if (worst_lx > *points_in_force[p].max_lx) share = std::min(share, *points_in_force[p].max_lx / worst_lx);
  }
  for (double& one : level) one *= share;
}

}  // namespace luxrig
