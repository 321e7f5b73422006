/// Failure domains: fixtures on a lost bus or dimmer are held, then go to their safe level; the rest goes on.

#include <fmt/format.h>

#include <algorithm>

#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

/// A meter with at most this share of its light from fixtures that do not answer still measures the others.
constexpr double kShareThatTells = 0.02;
/// A meter that showed more than its point's limit is trusted to watch it again below this share of the limit.
constexpr double kWellBelow = 0.95;

/// Without data, an output may do more than keep its level or go dark, unless a register map states its behaviour.
bool may_brighten(const Fixture& fixture) {
  const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch);
  return modbus == nullptr || modbus->map == nullptr;
}

/// Names in quotes; of many, the first few and the number of others, so that a phone shows them.
std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNames = 4;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMaxNames; ++i)
    text += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", names[i]);
  if (names.size() > kMaxNames) text += fmt::format(" and {} more", names.size() - kMaxNames);
  return text;
}

}  // namespace

bool ShowController::State::too_much_lost() const {
  return rig.safe.scope == SafeScope::rest_stays ? health.all_lost() : health.light_lost();
}

bool ShowController::State::limits_bear_waiting(Time now) const {
  if (!health.any_faulted()) return true;
  std::vector<double> most = present_levels(now);
  const std::vector<double> before = present_levels(now - kNoticedWithin);
  for (std::size_t f = 0; f < most.size(); ++f)
    most[f] = std::max({most[f], before[f], program.blackout ? 0.0 : program.to_level[f]});
  for (std::size_t p = 0; p < rig.points.size(); ++p)
    if (points_in_force[p].max_lx &&
        estimator.max_lux_at_point(p, most, now) > *points_in_force[p].max_lx * (1 + kBreachSlack))
      return false;
  return true;
}

/// Single losses are not tracked when the rig goes to its safe look as a whole, except those of bypassed fixtures.
void ShowController::State::watch_losses(Time now) {
  std::vector<std::uint8_t> apart(rig.fixtures.size());
  for (std::size_t f = 0; f < apart.size(); ++f)
    apart[f] = rig.safe.scope == SafeScope::rest_stays || bypassed.lamp(f) ? 1 : 0;
  const auto levels = [&] { return LostFixtures::Levels{present_levels(now), present_levels(now - kNoticedWithin)}; };
  bool changed = lost.step(now, health, apart, levels, from_seconds(rig.safe.hold_s));
  const std::vector<std::uint8_t> seen = watched_meters();
  if (lost.any()) changed = changed || seen != watched;
  if (!changed) return;
  watched = seen;
  tell_lost_lamps();
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i)
    if (in_doubt(i)) {
      readings.disbelieve(i);
      health.judged(i, now, "");  // its reading is no fault of its own
    }
  const bool goes_on = phase == Phase::moving || phase == Phase::fading || phase == Phase::settling ||
                       phase == Phase::measuring || phase == Phase::correcting || phase == Phase::holding;
  if (goes_on && cue && !failing) start_cue(now, asked);
}

/// 1 where a meter is read and shows no more than its point's limit.
std::vector<std::uint8_t> ShowController::State::watched_meters() const {
  std::vector<std::uint8_t> seen(rig.luxmeters.size(), 0);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Luxmeter& meter = rig.luxmeters[i];
    const std::optional<LuxReading>& believed = readings.believed()[i];
    if (health.meter_lost(i) || !believed || !meter.point) continue;
    const bool was = i >= watched.size() || watched[i] != 0;
    seen[i] = believed->lux <= points_in_force[*meter.point].max_lx.value_or(meter.range_lx) * (was ? 1 : kWellBelow);
  }
  return seen;
}

void ShowController::State::tell_lost_lamps() {
  std::vector<std::optional<GainEstimator::Lost>> lamps(rig.fixtures.size());
  for (std::size_t f = 0; f < lamps.size(); ++f) {
    if (!lost[f] || !lost[f]->lamp) continue;
    // While the present look is held anyway, the lamp is assumed to hold its level, too.
    const bool unknown = lost[f]->to_safe && may_brighten(rig.fixtures[f]);
    lamps[f] = GainEstimator::Lost{lost[f]->most, unknown ? 1.0 : lost[f]->most};
  }
  estimator.set_lost(std::move(lamps), watched);
  solving.facts_changed();
}

bool ShowController::State::in_doubt(std::size_t luxmeter) const {
  std::vector<std::uint8_t> chosen(rig.fixtures.size(), 0);
  bool any = false;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    // From the first report on: until the loss is certain, false readings look like true ones.
    chosen[f] = lost[f].has_value() || health.lamp_silent(f);
    any = any || chosen[f] != 0;
  }
  return any && estimator.share_at_meter(luxmeter, chosen, program.to_level) > kShareThatTells;
}

void ShowController::State::tell_losses(ShowStatus& status) const {
  std::vector<std::string> limited, lamps;
  for (const std::size_t p : estimator.beyond_dimming()) limited.push_back(rig.points[p].name);
  if (limited.empty()) return;
  Time since = Time::max();
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!lost[f] || !lost[f]->lamp || !may_brighten(rig.fixtures[f])) continue;
    lamps.push_back(rig.fixtures[f].name);
    since = std::min(since, lost[f]->since);
  }
  status.alarms.push_back(
      {true, "",
       fmt::format("nobody knows what light {} give{} now, and it could be above the limit of {}; look there, or cut "
                   "the power of {}",
                   some_of(lamps), lamps.size() == 1 ? "s" : "", some_of(limited), lamps.size() == 1 ? "it" : "them"),
       since});
}

}  // namespace luxrig
