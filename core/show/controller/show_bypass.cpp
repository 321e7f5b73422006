// Devices that a person has taken out of the show because they failed: the show without them, and the risk.
#include <fmt/format.h>

#include <algorithm>

#include "core/show/controller/show_state.h"

namespace luxrig {

double ShowController::State::max_of(std::size_t fixture) const {
  return parked(fixture) ? 0 : rig.max_level(rig.fixtures[fixture]);
}

void ShowController::State::bypass(Time now, std::span<const std::size_t> fixtures,
                                   std::span<const std::size_t> luxmeters, bool on) {
  const std::vector<std::size_t> lamps = bypassed.set_lamps(now, fixtures, on);
  for (const std::size_t f : lamps)
    if (!on) program.max_level[f] = max_of(f);
  const std::vector<std::size_t> meters = bypassed.set_meters(now, luxmeters, on);
  for (const std::size_t m : meters) {
    // What it taught may be as wrong as its readings now: it is not known when it failed.
    estimator.forget(m);
    readings.forget(m);
    scale.forget(m);
    faults.forget();
    health.judged(m, now, "");
  }
  if (lamps.empty() && meters.empty()) return;
  health.set_bypassed(bypassed.lamps(), bypassed.meters());
  progress.breaches.clear();
  if (!lamps.empty()) return start_with_hands(now);  // the rest is solved without them
  tell_estimator();
  // Limits that relied on it hold by the model alone from here on.
  if (cue && phase != Phase::idle) start_cue(now, asked);
}

/// Once a bypassed lamp is dark, nothing lights it, not even a desk.
void ShowController::State::close_bypassed(Time now) {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!bypassed.lamp(f) || program.max_level[f] <= 0 || program.to_level[f] > 0 || !program.done(now)) continue;
    program.max_level[f] = 0;
    ++program.revision;
  }
}

void ShowController::State::tell_bypassed(ShowStatus& status) const {
  const auto share = [](const PointStatus& point) {
    return point.light.lux > 0 ? 100 * point.light.half_width_lx / point.light.lux : 100.0;
  };
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!bypassed.lamp(f)) continue;
    const std::string& name = rig.fixtures[f].name;
    std::string risk = health.lamp_silent(f)
                           ? fmt::format(
                                 "fixture \"{}\" is bypassed and does not answer: nobody knows what light it "
                                 "gives, and none is asked of it",
                                 name)
                           : fmt::format(
                                 "fixture \"{}\" is bypassed: it is held dark, and the others make up for it "
                                 "as far as they can",
                                 name);
    status.bypassed.push_back({false, f, *bypassed.lamps()[f], std::move(risk)});
  }
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    if (!bypassed.meter(m)) continue;
    const Luxmeter& meter = rig.luxmeters[m];
    std::string risk = fmt::format("luxmeter \"{}\" is bypassed: it is not read", meter.name);
    if (meter.point) {
      const PointStatus& point = status.points[*meter.point];
      const std::string& name = rig.points[*meter.point].name;
      if (points_in_force[*meter.point].max_lx)
        risk += fmt::format("; the limit at {} is then watched by nobody: it is kept by the model alone, ± {:.0f} %",
                            name, share(point));
      else
        risk += fmt::format("; the light at {} is then known by the model alone, ± {:.0f} %", name, share(point));
    }
    status.bypassed.push_back({true, m, *bypassed.meters()[m], std::move(risk)});
  }
  for (const Bypassed& one : status.bypassed) {
    const std::string& name = one.luxmeter ? rig.luxmeters[one.index].name : rig.fixtures[one.index].name;
    status.alarms.push_back(
        {false, name, fmt::format("{}; when it is mended: luxrig bypass {} --undo", one.risk, name), one.since});
  }
}

void ShowController::bypass(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> luxmeters,
                            bool on) {
  now = state_->at_least_last(now);
  state_->bypass(now, fixtures, luxmeters, on);
}

}  // namespace luxrig
