#pragma once
/// How much light lamps have lost since they were first measured.

#include <optional>
#include <string>

#include "core/estimation/calibration.h"

namespace luxrig {

/// Keeps of an earlier calibration of the same rig what each lamp first gave. A lamp that gives more than before, by more
/// than kNewLamp standard errors, is taken to be a new one: it begins with what it gives now.
void keep_first_outputs(const Calibration& earlier, Calibration& found);
inline constexpr double kNewLamp = 3;

/// Output over the first one; none = it was not measured twice.
[[nodiscard]] std::optional<Known> ageing_of(const CalibratedFixture& fixture);
/// "-4.2 ± 1.1 % since 2026-08-01"; empty without any.
[[nodiscard]] std::string ageing_words(const CalibratedFixture& fixture);

}  // namespace luxrig
