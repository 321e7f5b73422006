#pragma once
/// What a camera measured, as a part of the page of a calibration.

#include <string>

#include "core/calibration/calibration_report.h"

namespace luxrig {

/// Empty if no camera measured.
[[nodiscard]] std::string camera_section(const CalibrationReport& report);

}  // namespace luxrig
