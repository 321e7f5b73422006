#pragma once
/// Reads a luminaire's file in either format, by its content. A misleading file name gives a warning.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/files/ies.h"
#include "core/photometry/files/lamp_tilt.h"
#include "core/photometry/files/luminous_opening.h"
#include "core/photometry/intensity.h"
#include "core/result.h"

namespace luxrig {

struct PhotometricFile {
  Intensity intensity;  ///< never null
  LuminousOpening opening;
  std::optional<LampTilt> tilt;
  double input_w = 0;                 ///< 0 = not stated
  std::vector<std::string> warnings;  ///< legal, but worth a look
};

/// Parses the text of a file. IES LM-63 has a line TILT=…; EULUMDAT has numbers in its lines 2 to 7. A text with
/// neither is read by its name (.ldt or .LDT is EULUMDAT, anything else IES), and refused by that parser.
[[nodiscard]] Checked<PhotometricFile> parse_photometric_text(std::string_view text, const std::string& file_name,
                                                              const TiltFiles& tilt_files = {});

}  // namespace luxrig
