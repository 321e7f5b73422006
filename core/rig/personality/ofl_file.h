#pragma once
/// Fixtures of the Open Fixture Library. Source: its fixture format, schema version 12
/// (github.com/OpenLightingProject/open-fixture-library, docs/fixture-format.md).

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/personality/personality.h"

namespace luxrig {

/// A fixture's JSON. The format names no manufacturer: that is the folder's name. `file` is for the messages. All modes
/// are read; a channel that switches its meaning has the one that it has by default. Angles count from one end of the
/// travel and nothing says where that points, so the middle of pan and tilt is taken as straight down.
[[nodiscard]] Checked<Personality> parse_ofl(std::string_view json, const std::string& manufacturer,
                                             const std::string& file);

}  // namespace luxrig
