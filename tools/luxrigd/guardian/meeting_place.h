#pragma once
/// Where a daemon and the commands of the same user find one another: for each port a Unix socket, and a file with the
/// token, in a runtime folder.

#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"
#include "tools/http/client.h"

namespace luxrig {

[[nodiscard]] std::filesystem::path socket_file(const std::filesystem::path& folder, int port);
[[nodiscard]] std::filesystem::path token_file(const std::filesystem::path& folder, int port);

/// Removes what daemons that were killed have left there.
void forget_dead_daemons(const std::filesystem::path& folder);

/// Nobody answers there, and what would mend it.
[[nodiscard]] Fault no_daemon(int port);
/// The daemon on that port as a command of this user reaches it: by its socket, or else by the port with the token of a
/// file.
[[nodiscard]] Result<HttpPeer> daemon_on(int port, const std::optional<std::filesystem::path>& token = {});

}  // namespace luxrig
