#pragma once
/// A luminaire's file of either format, by its content: a name that says otherwise is a warning.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/ies.h"
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

/// The text of a file. IES LM-63 has a line TILT=…, EULUMDAT numbers in its lines 2 to 7; what is neither is read as
/// its name says (.ldt or .LDT is EULUMDAT, anything else IES), and refused by that parser.
[[nodiscard]] Checked<PhotometricFile> parse_photometric_text(std::string_view text, const std::string& file_name,
                                                              const TiltFiles& tilt_files = {});

/// Reads, parses and makes the distribution; problems as load_ies() and load_eulumdat() give them.
[[nodiscard]] Checked<PhotometricFile> load_photometric_file(const std::filesystem::path& path);

}  // namespace luxrig
