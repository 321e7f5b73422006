#include "core/show/lost_fixtures.h"

#include <algorithm>

namespace luxrig {

void LostFixtures::lose(std::size_t f, Time now, const Levels& levels, bool lamp) {
  const double most = std::max({levels.present[f], levels.before[f], taken_level_[f]});
  lost_[f] = LostFixture{now, levels.present[f], most, lamp, false, {}};
}

bool LostFixtures::go_on(std::size_t f, Time now, bool gone, bool lamp, Duration hold) {
  std::optional<LostFixture>& one = lost_[f];
  if (!one) return false;
  if (!gone) {
    if (!one->well_since) one->well_since = now;
    if (now - *one->well_since < kHealthyFor) return false;
    one.reset();
    return true;
  }
  one->well_since.reset();
  bool changed = lamp && !one->lamp;
  one->lamp = one->lamp || lamp;
  if (!one->to_safe && now - one->since >= hold) one->to_safe = changed = true;
  return changed;
}

void LostFixtures::remember_levels(const HealthWatch& health, const std::vector<double>& level) {
  for (std::size_t f = 0; f < level.size(); ++f)
    if (!health.lamp_silent(f)) taken_level_[f] = level[f];
}

std::size_t LostFixtures::count() const {
  return static_cast<std::size_t>(
      std::count_if(lost_.begin(), lost_.end(), [](const auto& one) { return one.has_value(); }));
}

void LostFixtures::put_in(std::vector<double>& levels, const std::vector<double>& safe_levels) const {
  for (std::size_t f = 0; f < levels.size(); ++f)
    if (lost_[f]) levels[f] = lost_[f]->to_safe ? std::min(safe_levels[f], lost_[f]->level) : lost_[f]->level;
}

}  // namespace luxrig
