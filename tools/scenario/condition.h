#pragma once
/// Conditions as a person writes them.
///
///   SUBJECT NAME RELATION NUMBER [UNIT]     lux, reading, level, pan, tilt, lux_hours
///   SUBJECT RELATION NUMBER                 met, missed, unknown, alarms, exit
///   phase NAME · blackout · alarm TEXT
///
/// RELATION: < <= > >= == !=. In place of RELATION NUMBER also `between NUMBER and NUMBER`, and `== NUMBER +- NUMBER`
/// or `== NUMBER +- NUMBER %` for a figure with its tolerance. A NAME with spaces stands in single or double quotes; * and ? match several.

#include <string_view>

#include "core/rig/problem_list.h"
#include "tools/scenario/scenario.h"

namespace luxrig::scenario {

/// nullopt after reporting what is wrong. in_file: of the text's opening quote.
[[nodiscard]] std::optional<Condition> parse_condition(std::string_view text, const FilePosition& in_file,
                                                       const Rig& rig, ProblemList& problems);

/// The show at one instant.
struct Instant {
  const ShowStatus* status = nullptr;
  std::vector<double> lux, lux_hours;             ///< true, per point
  std::vector<std::optional<double>> reading_lx;  ///< per luxmeter, as last sent
  std::vector<double> level;                      ///< per fixture, as sent
  std::vector<Joints> joints;                     ///< true, per fixture
  std::optional<int> exit;                        ///< exit code of the daemon that ended last
};

/// Value of the condition's subject for the k-th of `which` (0 for a subject without names); for phase, alarm and
/// blackout 1 or 0. NaN: not known yet, and no condition on it holds.
[[nodiscard]] double value_at(const Condition& condition, std::size_t k, const Instant& instant);
[[nodiscard]] bool holds(const Condition& condition, double value);
/// For each of its names.
[[nodiscard]] bool holds_for_all(const Condition& condition, const Instant& instant);
/// The first name for which it holds (or, with `holding` false, does not); nullopt if there is none.
[[nodiscard]] std::optional<std::size_t> first_that(bool holding, const Condition& condition, const Instant& instant);
/// "drawing-1" for the k-th; empty without names.
[[nodiscard]] std::string name_at(const Condition& condition, std::size_t k, const Rig& rig);
/// "lux of drawing-1 is 52.3 lx", "phase is holding".
[[nodiscard]] std::string value_text(const Condition& condition, std::size_t k, const Instant& instant, const Rig& rig);

}  // namespace luxrig::scenario
