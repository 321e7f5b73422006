#pragma once
/// Readings of a luxmeter in a hand, typed or taken from its file, wherever they help most.

#include <filesystem>
#include <optional>

#include "tools/luxrig/calibrate/measuring.h"

namespace luxrig {

/// One place after the other, until the person ends it or no further place would help. A fault is of the daemon, or of
/// what is read.
[[nodiscard]] Result<void> measure_by_hand(Measuring& measuring,
                                           const std::optional<std::filesystem::path>& meter_file);

}  // namespace luxrig
