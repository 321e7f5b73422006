#pragma once
/// Where a daemon and the commands of the same user find one another: for each port a Unix socket, and a file with the
/// token, in a folder that is only that user's.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/http/client.h"

namespace luxrig {

/// `$XDG_RUNTIME_DIR/luxrig`, `/run/user/UID/luxrig`, `/tmp/luxrig-UID`: the first that can be had is the daemon's, and
/// a command looks in all.
[[nodiscard]] std::vector<std::filesystem::path> meeting_folders();
/// The first of them, made when it is not there (mode 700).
[[nodiscard]] Result<std::filesystem::path> make_meeting_folder();

[[nodiscard]] std::filesystem::path socket_file(const std::filesystem::path& folder, int port);
[[nodiscard]] std::filesystem::path token_file(const std::filesystem::path& folder, int port);

/// Nobody answers there, and what would mend it.
[[nodiscard]] Fault no_daemon(int port);
/// The daemon on that port as a command of this user reaches it: by its socket, or else by the port with the token of a
/// file.
[[nodiscard]] Result<HttpPeer> daemon_on(int port, const std::optional<std::filesystem::path>& token = {});

}  // namespace luxrig
