#pragma once
/// A luminaire's file of either format, by its name: .ldt is EULUMDAT, anything else IES LM-63.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/photometry/lamp_tilt.h"
#include "core/photometry/luminous_opening.h"
#include "core/result.h"

namespace luxrig {

struct PhotometricFile {
  Intensity intensity;  ///< never null
  LuminousOpening opening;
  std::optional<LampTilt> tilt;
  double input_w = 0;                 ///< 0: not stated
  std::vector<std::string> warnings;  ///< legal, but worth a look
};

/// Reads, parses and makes the distribution; problems as load_ies() and load_eulumdat() give them.
[[nodiscard]] Checked<PhotometricFile> load_photometric_file(const std::filesystem::path& path);

}  // namespace luxrig
