#pragma once
/// What a guardian that is sent away tells the daemon that takes the light from it: what goes out at that instant. A
/// line of JSON behind the number in its file. What is read is checked: the file may be anybody's.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {

[[nodiscard]] std::string handed_light_text(const LightInForce& light);

/// Nothing unless it has an entry for each of the fixtures, levels within 0…1, finite angles and times.
[[nodiscard]] std::optional<LightInForce> handed_light_of(const std::string& text, std::size_t fixtures);

}  // namespace luxrig
