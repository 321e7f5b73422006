#pragma once
/// How a daemon and commands of the same user find each other: for each port a Unix socket and a file with the token,
/// in a runtime folder.

#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"
#include "tools/http/client.h"

namespace luxrig {

[[nodiscard]] std::filesystem::path socket_file(const std::filesystem::path& folder, int port);
[[nodiscard]] std::filesystem::path token_file(const std::filesystem::path& folder, int port);

/// Removes the files that killed daemons have left there.
void forget_dead_daemons(const std::filesystem::path& folder);

/// Fault for a port where no daemon answers, with the remedy.
[[nodiscard]] Fault no_daemon(int port);
/// How a command of this user reaches the daemon on that port: by its socket, or by the port with the token of a file
/// if one is given.
[[nodiscard]] Result<HttpPeer> daemon_on(int port, const std::optional<std::filesystem::path>& token = {});

}  // namespace luxrig
