#pragma once
/// Fixtures of GDTF files. Source: DIN SPEC 15800 (General Device Type Format), DataVersion up to 1.2.

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/personality/personality.h"

namespace luxrig {

/// A whole .gdtf file (a zip archive with description.xml). `file` is for the messages. All problems are reported,
/// among them slots that two channels share or that lie outside 1…512.
[[nodiscard]] Checked<Personality> read_gdtf(std::string bytes, const std::string& file);

/// description.xml alone.
[[nodiscard]] Checked<Personality> parse_gdtf_description(std::string_view xml, const std::string& file);

}  // namespace luxrig
