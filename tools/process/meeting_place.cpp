#include "tools/process/meeting_place.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <chrono>
#include <fstream>

#include "tools/process/runtime_folder.h"

namespace luxrig {
namespace {

constexpr auto kBeingMade = std::chrono::seconds(10);
constexpr std::size_t kMaxSocketPath = sizeof(sockaddr_un::sun_path) - 1;

}  // namespace

std::filesystem::path socket_file(const std::filesystem::path& folder, int port) {
  return folder / (std::to_string(port) + ".socket");
}
std::filesystem::path token_file(const std::filesystem::path& folder, int port) {
  return folder / (std::to_string(port) + ".token");
}

void forget_dead_daemons(const std::filesystem::path& folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator file(folder, error), end; !error && file != end; file.increment(error)) {
    std::filesystem::path socket = file->path();
    std::error_code gone;
    // A new socket does not listen yet.
    const auto age = std::filesystem::file_time_type::clock::now() - std::filesystem::last_write_time(socket, gone);
    if (socket.extension() != ".socket" || gone || age < kBeingMade || http_listens(socket)) continue;
    std::filesystem::remove(socket, gone);
    std::filesystem::remove(socket.replace_extension(".token"), gone);
  }
}

Fault no_daemon(int port) {
  return {Cause::network,
          {},
          fmt::format("no daemon answers on 127.0.0.1:{}: start one with `luxrig run RIG`, or give its --port", port),
          {}};
}

Result<HttpPeer> daemon_on(int port, const std::optional<std::filesystem::path>& token) {
  HttpPeer peer;
  peer.port = port;
  if (token) {
    std::ifstream in(*token);
    if (!(in >> peer.token)) {
      return tl::unexpected(
          Fault{Cause::invalid, {}, fmt::format("--token {}: there is no token to be read", token->string()), {}});
    }
    return peer;
  }
  for (const auto& folder : runtime_folders()) {
    const std::string socket = socket_file(folder, port);
    if (socket.size() > kMaxSocketPath || !http_listens(socket)) continue;
    peer.socket = socket;
    return peer;
  }
  const auto answer = http_get(peer, "/api/session");
  if (answer && answer->status == 200) {
    return tl::unexpected(Fault{Cause::refused,
                                {},
                                fmt::format("the daemon on port {} belongs to another user: run it as that user, or "
                                            "with --token FILE",
                                            port),
                                {}});
  }
  if (!answer) return tl::unexpected(no_daemon(port));
  return tl::unexpected(
      Fault{Cause::network, {}, fmt::format("what answers on port {} is not a Luxrig daemon", port), {}});
}

}  // namespace luxrig
