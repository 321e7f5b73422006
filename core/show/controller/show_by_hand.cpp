/// Levels and goals that a person has set while the show runs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

/// A level that is lower than its setting by more than this counts as kept down.
constexpr double kSameLevel = 1e-3;

}  // namespace

Result<void> ShowController::State::hold(Time now, std::span<const ByHand> wanted, const ByHandTimes& times) {
  if (asked_safe) return refusal("the show has ended in its safe look: apply a plan first");
  for (const ByHand& one : wanted) {
    const bool level = one.what == ByHand::What::level;
    LUXRIG_CHECK(one.index < (level ? rig.fixtures.size() : rig.points.size()), "{} is none of the rig's", one.index);
    if (const std::string wrong = one.complaint(level && rig.fixtures[one.index].switched); !wrong.empty())
      return refusal(fmt::format("{}: {}", level ? rig.fixtures[one.index].name : rig.points[one.index].name, wrong));
  }
  if (times.measuring)
    if (auto may = may_measure(wanted); !may) return may;
  measuring = times.measuring;
  if (measuring) measured_beyond.reset();
  hands.set(rig, wanted);
  start_with_hands(now, times.fade_s);
  return {};
}

std::size_t ShowController::State::release(Time now, std::span<const std::size_t> fixtures,
                                           std::span<const std::size_t> points, std::optional<double> fade_s) {
  const std::size_t released = hands.release(fixtures, points);
  if (released > 0) start_with_hands(now, fade_s);
  return released;
}

void ShowController::State::release_what_is_over(Time now) {
  const HandSettings::Over over = hands.over(now);
  if (!over.empty()) release(now, over.fixtures, over.points);
}

/// Values that the look leaves out come from the rig.
void ShowController::State::take_points(const Look& look) {
  planned = look;
  const std::size_t count = rig.points.size();
  planned.goal_lx.resize(count);
  planned.max_lx.resize(count);
  planned.weight.resize(count);
  for (std::size_t p = 0; p < count; ++p) {
    if (look.goal_lx.empty()) planned.goal_lx[p] = rig.points[p].goal_lx;
    if (look.max_lx.empty()) planned.max_lx[p] = rig.points[p].max_lx;
    if (look.weight.empty()) planned.weight[p] = rig.points[p].weight;
  }
}

void ShowController::State::take_levels_of_plan(Time now, const std::vector<double>& levels, const Look& look) {
  std::vector<double> max_level;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) max_level.push_back(max_of(f));
  if (hands.take_plan(now, levels, look, max_level)) unsolved = true;
}

void ShowController::State::tell_estimator() {
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    points_in_force[p].goal_lx = hands.goal(p) ? std::optional(hands.goal(p)->value) : planned.goal_lx[p];
    points_in_force[p].max_lx = planned.max_lx[p];
    points_in_force[p].weight = planned.weight[p];
  }
  estimator.set_points(points_in_force);
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    estimator.set_held(f, hands.level(f) && !bypassed.lamp(f));
    estimator.set_max_level(f, bypassed.lamp(f) ? 0 : max_of(f));
  }
  tell_lost_lamps();
}

void ShowController::State::start_with_hands(Time now, std::optional<double> fade_s) {
  unsolved = true;
  hands_fade_s = fade_s;
  tell_estimator();
  if (cue) start_cue(now, with_hands(hands.levels_without()), fade_s);
}

std::vector<double> ShowController::State::with_hands(std::vector<double> levels) const {
  for (std::size_t f = 0; f < levels.size(); ++f)
    if (bypassed.lamp(f))
      levels[f] = 0;
    else if (hands.level(f))
      levels[f] = std::min(hands.level(f)->value, program.max_level[f]);
  return levels;
}

/// Why a setting by hand is not in effect; empty if it is.
std::string ShowController::State::why_not(Time now, const ByHand& held) const {
  if (program.blackout) return "blackout";
  if (phase == Phase::safe || phase == Phase::safe_fading) return "safe look";
  if (phase == Phase::frozen) return "the light is held, as something has failed";
  if (!cue) return "no plan is in force yet";
  if (held.what == ByHand::What::goal) {
    const std::optional<double> max_lx = points_in_force[held.index].max_lx;
    if (max_lx && held.value > *max_lx) return fmt::format("its limit of {:g} lx wins", *max_lx);
    return held.index < progress.why.size() ? progress.why[held.index] : std::string();
  }
  if (lost[held.index]) return "it does not answer: it is held as it was, then goes to its safe level";
  if (bypassed.lamp(held.index)) return "it is bypassed";
  if (parked(held.index)) return "it is parked until the next plan";
  const double most = program.max_level[held.index];
  if (held.value > most + kSameLevel) return fmt::format("the most it may have is {:g} (max_level)", most);
  if (program.to_level[held.index] >= held.value - kSameLevel) return {};
  // Limits that would be exceeded with this lamp at its set level, beside the present light.
  std::vector<double> level = program.to_level;
  level[held.index] = held.value;
  std::string limits;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!points_in_force[p].max_lx || estimator.max_lux_at_point(p, level, now) <= *points_in_force[p].max_lx) continue;
    limits += fmt::format("{}\"{}\" ({:g} lx)", limits.empty() ? "" : ", ", points_in_force[p].name,
                          *points_in_force[p].max_lx);
  }
  return limits.empty()
             ? fmt::format("{:.3f} is the most that limits leave", program.to_level[held.index])
             : fmt::format("the limit of point {} wins: {:.3f} is the most", limits, program.to_level[held.index]);
}

Result<void> ShowController::hold(Time now, std::span<const ByHand> wanted, const ByHandTimes& times) {
  now = state_->at_least_last(now);
  return state_->hold(now, wanted, times);
}

std::size_t ShowController::release(Time now, std::span<const std::size_t> fixtures,
                                    std::span<const std::size_t> points, std::optional<double> fade_s) {
  now = state_->at_least_last(now);
  const std::size_t aims = state_->sharing.release(state_->program, now, fixtures);
  return aims + state_->release(now, fixtures, points, fade_s);
}

std::vector<ByHand> ShowController::by_hand() const { return state_->hands.all(); }

}  // namespace luxrig
