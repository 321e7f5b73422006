#pragma once
/// Measuring while visitors are there: the look stays, and each lamp changes by a hair.

#include "tools/luxrig/calibrate/measuring.h"

namespace luxrig {

/// As many whole rounds of the pattern (core/calibration/open_run.h) as there is time for, at least one.
[[nodiscard]] Result<void> by_meters_in_open_hours(Measuring& measuring, double minutes);

}  // namespace luxrig
