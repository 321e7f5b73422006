#include "tools/scenario/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig::scenario {
namespace {

using Kind = Expectation::Kind;

/// A tick is 0.02 s: instants this much nearer count as one.
constexpr double kInstant_s = 1e-6;

}  // namespace

Judge::Judge(const Scenario& scenario, const Rig& rig, double slack_s)
    : scenario_(scenario), rig_(rig), slack_s_(slack_s) {
  for (const Expectation& expectation : scenario.expectations) {
    State state;
    if (!expectation.after) state.begins_s = expectation.from_s;
    states_.push_back(std::move(state));
    Judged judged;
    judged.expected = expectation.text();
    judged.why = expectation.why;
    judged.line = expectation.in_file.line;
    judged_.push_back(std::move(judged));
  }
}

void Judge::happened(std::size_t event, double at_s) {
  for (std::size_t e = 0; e < states_.size(); ++e)
    if (scenario_.expectations[e].after == event && !states_[e].begins_s)
      states_[e].begins_s = at_s + scenario_.expectations[e].from_s;
}

double Judge::shrink_s(std::size_t e) const {
  const Expectation& expectation = scenario_.expectations[e];
  if (expectation.kind != Kind::always && expectation.kind != Kind::never) return 0;
  // Half of a short time is still judged.
  return std::min(slack_s_, expectation.within_s.value_or(HUGE_VAL) / 4);
}

double Judge::from_s(std::size_t e) const {
  const bool from_start = !scenario_.expectations[e].after && !(scenario_.expectations[e].from_s > 0);
  return *states_[e].begins_s + (from_start ? 0 : shrink_s(e));
}

double Judge::ends_s(std::size_t e) const {
  const Expectation& expectation = scenario_.expectations[e];
  if (!expectation.within_s) return HUGE_VAL;
  const double ends_s = *states_[e].begins_s + *expectation.within_s - shrink_s(e);
  return expectation.kind == Kind::reached ? ends_s + slack_s_ : ends_s;
}

void Judge::fail(std::size_t e, double at_s, std::string found) {
  judged_[e].held = false;
  judged_[e].at_s = at_s;
  judged_[e].found = std::move(found);
  states_[e].over = true;
}

void Judge::look(double at_s, const Instant& instant) {
  for (std::size_t e = 0; e < states_.size(); ++e) {
    State& state = states_[e];
    if (state.over || !state.begins_s || at_s < from_s(e) - kInstant_s) continue;
    const Expectation& expectation = scenario_.expectations[e];
    const Condition& condition = expectation.condition;
    state.known = state.known || !std::isnan(value_at(condition, 0, instant));
    const bool past = at_s > ends_s(e) + kInstant_s, last = at_s >= ends_s(e) - kInstant_s;
    switch (expectation.kind) {
      case Kind::always:
      case Kind::never: {
        if (past) {
          state.over = true;
          break;
        }
        const bool wrong = expectation.kind == Kind::never;
        const auto k = first_that(wrong, condition, instant);
        // What is not known yet breaks nothing.
        if (k && !std::isnan(value_at(condition, *k, instant))) fail(e, at_s, value_text(condition, *k, instant, rig_));
        break;
      }
      case Kind::reached: {
        const auto k = first_that(false, condition, instant);
        if (!k && !past) {
          state.over = true;
          break;
        }
        if (k) state.last = value_text(condition, *k, instant, rig_);
        if (past) fail(e, at_s, fmt::format("not within {:g} s: {}", *expectation.within_s, state.last));
        break;
      }
      case Kind::at_end:
        if (const auto k = first_that(false, condition, instant))
          state.last = value_text(condition, *k, instant, rig_);
        else
          state.last.clear();
        if (!last) break;
        if (state.last.empty())
          state.over = true;
        else
          fail(e, at_s, state.last);
        break;
    }
  }
}

std::vector<Judged> Judge::end(double at_s) {
  for (std::size_t e = 0; e < states_.size(); ++e) {
    const State& state = states_[e];
    const Expectation& expectation = scenario_.expectations[e];
    if (state.begins_s && !state.known && judged_[e].held) {
      fail(e, at_s, *state.begins_s > at_s ? "its time never came" : "its value was never known");
      continue;
    }
    if (state.over) continue;
    if (!state.begins_s) {
      fail(e, at_s, fmt::format("\"{}\" never happened", scenario_.events[*expectation.after].name));
    } else if (expectation.kind == Kind::reached) {
      fail(e, at_s, "not by the end of the show: " + state.last);
    } else if (expectation.kind == Kind::at_end && !state.last.empty()) {
      fail(e, at_s, state.last);
    }
  }
  return judged_;
}

}  // namespace luxrig::scenario
