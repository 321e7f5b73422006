#pragma once
/// Readings of a luxmeter in a hand, wherever they help most: typed, taken from its file, or of a simulated hand.

#include <filesystem>
#include <optional>
#include <string>

#include "tools/luxrig/calibrate/measuring.h"

namespace luxrig {

/// One place after the other, until the person ends it or no further place would help. A fault is of the daemon, or of
/// what is read.
[[nodiscard]] Result<void> measure_by_hand(Measuring& measuring,
                                           const std::optional<std::filesystem::path>& meter_file);
/// The same by a simulated hand in the daemon's simulated rig, at so many places at most. world: what it says of itself.
[[nodiscard]] Result<void> measure_by_simulated_hand(Measuring& measuring, int places, const std::string& world);

}  // namespace luxrig
