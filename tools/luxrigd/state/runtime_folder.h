#pragma once
/// Where what lives as long as a process may be kept, out of other users' reach.

#include <filesystem>
#include <optional>
#include <vector>

namespace luxrig {

/// $XDG_RUNTIME_DIR/luxrig, /run/luxrig for root, /run/user/UID/luxrig, /tmp/luxrig-UID: those of them that are there,
/// this user's and nobody else's (mode 700). A service and a terminal of the same user may differ in which comes first.
[[nodiscard]] std::vector<std::filesystem::path> runtime_folders();

/// The first of them that is there or can be made. Nothing where none can be.
[[nodiscard]] std::optional<std::filesystem::path> runtime_folder();

}  // namespace luxrig
