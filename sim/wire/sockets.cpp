#include "sim/wire/sockets.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace luxrig::sim {
namespace {

Result<BoundSocket> bound(int type, int port) {
  const auto failed = [port](const char* call) {
    return tl::unexpected(
        Fault{Cause::system,
              "",
              fmt::format("{} on 127.0.0.1 port {}: {}", call, port, std::generic_category().message(errno)),
              {}});
  };
  Descriptor descriptor(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!descriptor.open()) return failed("socket");
  // A restarted simulator must get its port back although old connections are still in TIME_WAIT.
  const int yes = 1;
  if (type == SOCK_STREAM) ::setsockopt(descriptor.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::bind(descriptor.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return failed("bind");
  if (type == SOCK_STREAM && ::listen(descriptor.get(), 16) != 0) return failed("listen");
  socklen_t length = sizeof address;
  if (::getsockname(descriptor.get(), reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    return failed("getsockname");
  }
  return BoundSocket{std::move(descriptor), ntohs(address.sin_port)};
}

}  // namespace

void Descriptor::reset() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Result<BoundSocket> bind_udp(int port) { return bound(SOCK_DGRAM, port); }
Result<BoundSocket> listen_tcp(int port) { return bound(SOCK_STREAM, port); }

}  // namespace luxrig::sim
