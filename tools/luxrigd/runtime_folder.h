#pragma once
/// Where what lives as long as a process may be kept, out of other users' reach.

#include <filesystem>
#include <optional>

namespace luxrig {

/// $XDG_RUNTIME_DIR/luxrig, /run/luxrig for root, else /tmp/luxrig-UID; made with mode 700. Nothing where that cannot
/// be, or is somebody else's.
[[nodiscard]] std::optional<std::filesystem::path> runtime_folder();

}  // namespace luxrig
