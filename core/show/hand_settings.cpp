#include "core/show/hand_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"
#include "core/rig/housing.h"

namespace luxrig {
namespace {

constexpr double kMaxGoal_lx = 1e6;

std::size_t released(std::vector<std::optional<ByHand>>& settings, std::span<const std::size_t> which) {
  std::size_t count = 0;
  for (const std::size_t i : which) {
    if (!settings.at(i)) continue;
    settings[i].reset();
    ++count;
  }
  return count;
}

std::vector<std::size_t> over_at(Time now, const std::vector<std::optional<ByHand>>& settings) {
  std::vector<std::size_t> over;
  for (std::size_t i = 0; i < settings.size(); ++i)
    if (settings[i] && settings[i]->until && *settings[i]->until <= now) over.push_back(i);
  return over;
}

}  // namespace

std::string ByHand::complaint(bool switched) const {
  if (what == What::goal) {
    if (value >= 0 && value <= kMaxGoal_lx) return {};
    return fmt::format("a goal is 0 to {:g} lx, not {:g}", kMaxGoal_lx, value);
  }
  if (!(value >= 0 && value <= 1)) return fmt::format("a level is 0 (dark) to 1 (full), not {:g}", value);
  if (switched && value > 0 && value < 1) return fmt::format("it is on or off: give 0 or 1, not {:g}", value);
  return {};
}

void HandSettings::set(const Rig& rig, std::span<const ByHand> wanted) {
  for (const ByHand& one : wanted) {
    if (one.what == ByHand::What::goal) {
      LUXRIG_CHECK(one.index < goal_.size(), "point {} of {}", one.index, goal_.size());
      goal_[one.index] = one;
      continue;
    }
    LUXRIG_CHECK(one.index < level_.size(), "fixture {} of {}", one.index, level_.size());
    std::vector<std::size_t> fixtures = {one.index};
    if (one.whole_housing) fixtures = housing_of(rig, one.index);
    double brightest = 0;
    for (const std::size_t f : fixtures) brightest = std::max(brightest, levels_without_[f]);
    for (const std::size_t f : fixtures) {
      level_[f] = one;
      level_[f]->index = f;
      level_[f]->whole_housing = false;
      if (fixtures.size() > 1 && brightest > 0) level_[f]->value = one.value * levels_without_[f] / brightest;
    }
  }
}

std::size_t HandSettings::release(std::span<const std::size_t> fixtures, std::span<const std::size_t> points) {
  return released(level_, fixtures) + released(goal_, points);
}

HandSettings::Over HandSettings::over(Time now) const { return {over_at(now, level_), over_at(now, goal_)}; }

bool HandSettings::take_plan(Time now, const std::vector<double>& levels, const Look& look,
                             std::span<const double> max_level) {
  bool stay = std::any_of(goal_.begin(), goal_.end(), [](const auto& goal) { return goal.has_value(); });
  levels_without_ = levels;
  for (std::size_t f = 0; f < levels.size(); ++f) {
    if (level_[f] && !level_[f]->of_plan) {
      stay = true;
      continue;
    }
    level_[f].reset();
    if (look.solved_levels.empty() || !look.solved_levels[f]) continue;
    level_[f] = ByHand{ByHand::What::level, f, levels[f], now};
    level_[f]->of_plan = true;
    levels_without_[f] = std::min(*look.solved_levels[f], max_level[f]);
  }
  return stay;
}

void HandSettings::exchange_points(const std::vector<Point>& before, const std::vector<Point>& after) {
  std::vector<std::optional<ByHand>> goals(after.size());
  for (std::size_t p = 0; p < after.size(); ++p)
    for (std::size_t q = 0; q < before.size(); ++q)
      if (before[q].name == after[p].name && goal_[q]) {
        goals[p] = goal_[q];
        goals[p]->index = p;
      }
  goal_ = std::move(goals);
}

std::vector<ByHand> HandSettings::all() const {
  std::vector<ByHand> all;
  for (const auto& one : level_)
    if (one) all.push_back(*one);
  for (const auto& one : goal_)
    if (one) all.push_back(*one);
  return all;
}

}  // namespace luxrig
