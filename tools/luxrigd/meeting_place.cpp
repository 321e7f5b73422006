#include "tools/luxrigd/meeting_place.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace luxrig {
namespace {

constexpr std::size_t kMaxSocketPath = sizeof(sockaddr_un::sun_path) - 1;

/// A folder of ours that nobody else can write to or look into.
bool is_private_folder(const std::filesystem::path& folder) {
  struct stat is {};
  return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
         (is.st_mode & (S_IRWXG | S_IRWXO)) == 0;
}

}  // namespace

std::vector<std::filesystem::path> meeting_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* runtime = std::getenv("XDG_RUNTIME_DIR"); runtime && runtime[0] == '/')
    folders.emplace_back(std::filesystem::path(runtime) / "luxrig");
  const std::string user = std::to_string(::geteuid());
  folders.emplace_back("/run/user/" + user + "/luxrig");
  folders.emplace_back("/tmp/luxrig-" + user);
  return folders;
}

Result<std::filesystem::path> make_meeting_folder() {
  for (const auto& folder : meeting_folders()) {
    if (::mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST) continue;
    if (is_private_folder(folder) && socket_file(folder, 65535).string().size() <= kMaxSocketPath) return folder;
  }
  return tl::unexpected(Fault{Cause::system,
                              {},
                              fmt::format("no folder for the daemon's socket: {} is not this user's alone (mode 700): "
                                          "remove it, or set XDG_RUNTIME_DIR",
                                          meeting_folders().back().string()),
                              {}});
}

std::filesystem::path socket_file(const std::filesystem::path& folder, int port) {
  return folder / (std::to_string(port) + ".socket");
}
std::filesystem::path token_file(const std::filesystem::path& folder, int port) {
  return folder / (std::to_string(port) + ".token");
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
  for (const auto& folder : meeting_folders()) {
    const std::string socket = socket_file(folder, port);
    if (socket.size() > kMaxSocketPath || !is_private_folder(folder) || !http_listens(socket)) continue;
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
