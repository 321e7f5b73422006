#pragma once
/// Fixtures from the Open Fixture Library. Source: its fixture format, schema version 12
/// (github.com/OpenLightingProject/open-fixture-library, docs/fixture-format.md).

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/personality/personality.h"

namespace luxrig {

/// Reads a fixture's JSON. The manufacturer is not in the file: it is the name of its folder. `file` is for messages.
/// Reads all modes. A switching channel is read with its default meaning. Angles count from one end of the travel, and
/// the format does not say where that points, so the middle of pan and tilt is taken as straight down.
[[nodiscard]] Checked<Personality> parse_ofl(std::string_view json, const std::string& manufacturer,
                                             const std::string& file);

}  // namespace luxrig
