#include "core/output/startup_stages.h"

#include <algorithm>
#include <map>

namespace luxrig {
namespace {

constexpr int kBurningStage = 0;  // those of a rig file begin at 1

}  // namespace

double LampStart::ceiling(Time now) const {
  if (now < begin || begin == kWithoutPower) return held;
  const Duration up = now - begin;
  return up >= rise ? 1.0 : std::max(held, static_cast<double>(up.count()) / static_cast<double>(rise.count()));
}

Time all_up(const LampStarts& lamps) {
  Time last{};
  for (const LampStart& lamp : lamps) {
    if (lamp.begin != kWithoutPower) last = std::max(last, lamp.begin + lamp.rise);
  }
  return last;
}

LampStarts lamp_starts(const Rig& rig, std::span<const double> max_level, std::span<const std::uint8_t> starts,
                       Time power, Time not_before, std::span<const double> burning) {
  const auto burns = [&](std::size_t f) { return f < burning.size() ? std::clamp(burning[f], 0.0, 1.0) : 0.0; };
  LampStarts lamps(rig.fixtures.size());
  std::map<int, std::vector<std::size_t>> stages;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (starts[f] != 0) stages[burns(f) > 0 ? kBurningStage : rig.fixtures[f].stage].push_back(f);
  }
  const Duration rise = from_seconds(rig.control.fade_s);
  Time stage_begins = std::max(power, not_before), free = stage_begins;
  for (const auto& [number, fixtures] : stages) {
    for (const std::size_t f : fixtures) {
      const Fixture& fixture = rig.fixtures[f];
      const double held = burns(f);
      lamps[f] = {held > 0 ? stage_begins : std::max(stage_begins, power + from_seconds(fixture.reset_s)), rise, held};
      if (rig.startup.max_watts_per_s) {
        const double watts = rig.luminaires[fixture.luminaire].watts.value_or(0) * max_level[f];
        // Rounded up to the next nanosecond, so that it is never faster than allowed.
        lamps[f].begin = std::max(lamps[f].begin, free);
        lamps[f].rise = from_seconds(watts / *rig.startup.max_watts_per_s) + Duration(1);
      }
      lamps[f].begin -= from_seconds(held * to_seconds(lamps[f].rise));  // it has already risen so far
      free = std::max(free, lamps[f].begin + lamps[f].rise);
    }
    stage_begins =
        std::max(stage_begins + from_seconds(rig.startup.stage_s), rig.startup.max_watts_per_s ? free : Time{});
  }
  return lamps;
}

}  // namespace luxrig
