#pragma once
/// How far the truth differs from the rig file, as text: `luxrig-sim --deviations`, and scenarios.

#include <string>

#include "core/result.h"
#include "sim/world/deviations.h"

namespace luxrig::sim {

/// "mild", "real", "bad", "none", or one followed by changes: "none,meter_noise=0.003,lamp_lag_s=0.05". Keys are the fields of
/// Deviations (sim/world/deviations.h). The seed stays 1. Problems name no place in the text.
[[nodiscard]] Checked<Deviations> parse_deviations(const std::string& text, const std::string& file = "--deviations");

}  // namespace luxrig::sim
