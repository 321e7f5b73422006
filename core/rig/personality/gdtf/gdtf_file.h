#pragma once
/// Fixtures from GDTF files. Source: DIN SPEC 15800 (General Device Type Format), DataVersion up to 1.2.

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/personality/personality.h"

namespace luxrig {

/// Reads a whole .gdtf file (a zip archive with description.xml). `file` is for messages. Reports all problems,
/// including slots shared by two channels and slots outside 1…512.
[[nodiscard]] Checked<Personality> read_gdtf(std::string bytes, const std::string& file);

/// Reads description.xml alone.
[[nodiscard]] Checked<Personality> parse_gdtf_description(std::string_view xml, const std::string& file);

}  // namespace luxrig
