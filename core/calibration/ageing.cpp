#include "core/calibration/ageing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr std::size_t kDate = sizeof("2026-11-28") - 1;

Known ratio(const Known& now, const Known& then) {
  const double share = now.value / then.value;
  return {share, share * std::hypot(now.standard_error / now.value, then.standard_error / then.value)};
}

bool was_measured(const Known& output) { return output.standard_error > 0 && output.value > 0; }

}  // namespace

void keep_first_outputs(const Calibration& earlier, Calibration& found) {
  for (CalibratedFixture& lamp : found.fixtures) {
    const auto before = std::find_if(earlier.fixtures.begin(), earlier.fixtures.end(),
                                     [&](const CalibratedFixture& each) { return each.name == lamp.name; });
    if (before == earlier.fixtures.end()) continue;
    std::optional<FirstOutput> first = before->first;
    if (!first && was_measured(before->output)) first = FirstOutput{earlier.made, before->output};
    if (!first || !was_measured(first->output)) continue;
    // What was known of its first light is not lost by a time when no meter saw it.
    if (was_measured(lamp.output)) {
      const Known change = ratio(lamp.output, was_measured(before->output) ? before->output : first->output);
      if (change.value - kNewLamp * change.standard_error > 1) continue;
    }
    lamp.first = first;
  }
}

std::optional<Known> ageing_of(const CalibratedFixture& fixture) {
  if (!fixture.first || !was_measured(fixture.output) || !was_measured(fixture.first->output)) return std::nullopt;
  return ratio(fixture.output, fixture.first->output);
}

std::string ageing_words(const CalibratedFixture& fixture) {
  const auto share = ageing_of(fixture);
  if (!share) return "";
  return fmt::format("{:+.1f} ± {:.1f} % since {}", 100 * (share->value - 1), 100 * share->standard_error,
                     fixture.first->since.substr(0, kDate));
}

}  // namespace luxrig
