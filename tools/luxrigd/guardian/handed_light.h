#pragma once
/// The light that a guardian hands to the daemon that sends it away: its output at that instant. One line of JSON after
/// the process id in its pid file. It is checked on reading, as anyone may have written the file.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {

[[nodiscard]] std::string handed_light_text(const LightInForce& light);

/// nullopt unless it has an entry per fixture, levels within 0…1, finite angles and times.
[[nodiscard]] std::optional<LightInForce> handed_light_of(const std::string& text, std::size_t fixtures);

}  // namespace luxrig
