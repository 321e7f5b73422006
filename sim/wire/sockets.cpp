#include "sim/wire/sockets.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <system_error>

namespace luxrig::sim {
namespace {

sockaddr_in socket_address(std::uint32_t address, int port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(address);
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  return place;
}

tl::unexpected<Fault> socket_failed(const char* call, std::uint32_t address, int port) {
  std::string detail =
      fmt::format("{} on {} port {}: {}", call, address_text(address), port, std::generic_category().message(errno));
  if (errno == EADDRNOTAVAIL) detail += ": this computer has no such address, `ip address` lists its addresses";
  if (errno == EADDRINUSE) detail += ": end the program that has the port, or use another address of this computer";
  if (errno == EACCES && port < 1024) detail += ": ports below 1024 need root or CAP_NET_BIND_SERVICE";
  return tl::unexpected(Fault{Cause::system, "", std::move(detail), {}});
}

Result<BoundSocket> bound(int type, int port, std::uint32_t address, bool shared) {
  const auto failed = [=](const char* call) { return socket_failed(call, address, port); };
  Descriptor descriptor(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!descriptor.open()) return failed("socket");
  // A restarted simulator must get its port back although old connections are still in TIME_WAIT.
  const int yes = 1, no = 0;
  if (type == SOCK_STREAM || shared) ::setsockopt(descriptor.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  // Multicast has sockets of its own. Without this, a socket on all addresses gets each packet a second time.
  if (type == SOCK_DGRAM) ::setsockopt(descriptor.get(), IPPROTO_IP, IP_MULTICAST_ALL, &no, sizeof no);
  sockaddr_in place = socket_address(address, port);
  if (::bind(descriptor.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) return failed("bind");
  if (type == SOCK_STREAM && ::listen(descriptor.get(), 16) != 0) return failed("listen");
  socklen_t length = sizeof place;
  if (::getsockname(descriptor.get(), reinterpret_cast<sockaddr*>(&place), &length) != 0) return failed("getsockname");
  return BoundSocket{std::move(descriptor), ntohs(place.sin_port)};
}

struct Interface {
  std::string name;
  int index = 0;
  std::uint32_t broadcast = 0;  ///< 0 = none
};

// The interfaces whose network the address is in; every one for kAnyAddress.
std::vector<Interface> interfaces_of(std::uint32_t address) {
  std::vector<Interface> interfaces;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return interfaces;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  const auto address_of = [](const sockaddr* place) {
    return ntohl(reinterpret_cast<const sockaddr_in*>(place)->sin_addr.s_addr);
  };
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET || entry->ifa_netmask == nullptr) continue;
    if ((entry->ifa_flags & IFF_UP) == 0) continue;
    const std::uint32_t own = address_of(entry->ifa_addr), mask = address_of(entry->ifa_netmask);
    const bool loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    // All of 127.0.0.0/8 is this machine; elsewhere only the address itself is.
    if (address != kAnyAddress && (loopback ? (address & mask) != (own & mask) : address != own)) continue;
    const bool has_broadcast = loopback || (entry->ifa_flags & IFF_BROADCAST) != 0;
    interfaces.push_back({entry->ifa_name, static_cast<int>(::if_nametoindex(entry->ifa_name)),
                          has_broadcast && mask != 0xffffffff ? own | ~mask : 0});
  }
  return interfaces;
}

}  // namespace

std::string address_text(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 255, address >> 8 & 255, address & 255);
}

void Descriptor::reset() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Result<BoundSocket> bind_udp(int port, std::uint32_t address) { return bound(SOCK_DGRAM, port, address, false); }
Result<BoundSocket> share_udp(int port, std::uint32_t address) { return bound(SOCK_DGRAM, port, address, true); }
Result<BoundSocket> listen_tcp(int port, std::uint32_t address) { return bound(SOCK_STREAM, port, address, false); }

Result<Descriptor> claim_udp(int port, std::uint32_t address) {
  // A name in the abstract namespace ends with its process, and is of one network namespace, as the port is.
  const std::string name = fmt::format("luxrig-sim udp {}:{}", address_text(address), port);
  Descriptor claim(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!claim.open()) return socket_failed("socket", address, port);
  sockaddr_un place{};
  place.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), place.sun_path + 1);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (::bind(claim.get(), reinterpret_cast<const sockaddr*>(&place), length) != 0)
    return socket_failed("another luxrig-sim listens", address, port);
  return claim;
}

Result<Descriptor> join_multicast(int port, std::uint32_t group, std::uint32_t address) {
  // A socket of its own for each group: Linux allows one socket 20 groups, and one that is bound to the group gets
  // nothing else.
  auto socket = bound(SOCK_DGRAM, port, group, true);
  if (!socket) return tl::unexpected(socket.error());
  bool joined = false;
  errno = ENODEV;
  for (const Interface& interface : interfaces_of(address)) {
    ip_mreqn membership{};
    membership.imr_multiaddr.s_addr = htonl(group);
    membership.imr_ifindex = interface.index;
    if (::setsockopt(socket->descriptor.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0 ||
        errno == EADDRINUSE)  // a second address of the same interface
      joined = true;
  }
  if (!joined) return socket_failed("multicast", group, port);
  return std::move(socket->descriptor);
}

Result<std::vector<Descriptor>> hear_broadcasts(int port, std::uint32_t address) {
  std::vector<Descriptor> sockets;
  if (address == kAnyAddress) return sockets;
  for (const Interface& interface : interfaces_of(address)) {
    if (interface.broadcast == 0) continue;
    for (const std::uint32_t to : {interface.broadcast, std::uint32_t{INADDR_BROADCAST}}) {
      auto socket = bound(SOCK_DGRAM, port, to, true);
      if (!socket) return tl::unexpected(socket.error());
      // 255.255.255.255 is the same on every network, and only this one's is wanted. Before Linux 5.7 that needs a
      // privilege; without it, only the network's own broadcasts are heard.
      if (to == INADDR_BROADCAST &&
          ::setsockopt(socket->descriptor.get(), SOL_SOCKET, SO_BINDTODEVICE, interface.name.c_str(),
                       static_cast<socklen_t>(interface.name.size())) != 0)
        continue;
      sockets.push_back(std::move(socket->descriptor));
    }
  }
  return sockets;
}

std::uint32_t own_address_towards(std::uint32_t peer) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in place = socket_address(peer, 9);  // connecting a datagram socket sends nothing
  socklen_t length = sizeof place;
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
      ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&place), &length) != 0)
    return kLoopback;
  return ntohl(place.sin_addr.s_addr);
}

bool may_listen_on(int port) {
  const Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in place = socket_address(kLoopback, port);
  return ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0 || errno != EACCES;
}

}  // namespace luxrig::sim
