#pragma once
/// What a calibration leaves behind.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/calibration.h"
#include "tools/luxrig/calibrate/by_heads.h"
#include "tools/luxrig/calibrate/measuring.h"

namespace luxrig {

struct MeasuredRig {
  const Measuring& measuring;
  const Session& with_places;  ///< with the cameras' places as points
  const RigLight& before;      ///< when nothing was measured
  const std::vector<MeasuredHead>& heads;
  const std::vector<double>& look;  ///< levels that the daemon went back to
  std::filesystem::path file;
  std::string world;  ///< simulated; empty = real
  const std::optional<Calibration>& earlier;
  std::vector<std::string> by;  ///< what measured
};

/// Writes the file, and keeps the one before under the time it was made; beside it a report as a page and as JSON, and
/// the cameras' maps of light. Prints the report. The page.
[[nodiscard]] Result<std::filesystem::path> keep_result(const MeasuredRig& measured, const ComputeOptions& compute);

}  // namespace luxrig
