#pragma once
/// Folder for files that live as long as a process, out of other users' reach.

#include <filesystem>
#include <optional>
#include <vector>

namespace luxrig {

/// Those of $XDG_RUNTIME_DIR/luxrig, /run/luxrig for root, /run/user/UID/luxrig and /tmp/luxrig-UID that exist and
/// belong to this user alone (mode 700). A user's service and terminal may differ in which comes first.
[[nodiscard]] std::vector<std::filesystem::path> runtime_folders();

/// The first of them that exists or can be made; nullopt if none can.
[[nodiscard]] std::optional<std::filesystem::path> runtime_folder();

}  // namespace luxrig
