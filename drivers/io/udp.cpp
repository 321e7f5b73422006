#include "drivers/io/udp.h"

#include <arpa/inet.h>
#include <linux/errqueue.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <set>

#include "drivers/io/os_fault.h"

namespace luxrig {
namespace {

sockaddr_in to_sockaddr(const SocketAddress& address) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(address.ipv4);
  out.sin_port = htons(address.port);
  return out;
}

SocketAddress from_sockaddr(const sockaddr_in& in) { return {ntohl(in.sin_addr.s_addr), ntohs(in.sin_port)}; }

class Udp final : public DatagramChannel {
 public:
  explicit Udp(UdpSettings settings) : settings_(std::move(settings)) {}
  ~Udp() override { close(); }
  Udp(const Udp&) = delete;
  Udp& operator=(const Udp&) = delete;

  Result<void> open() override {
    if (fd_ >= 0) return {};
    fd_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd_ < 0) return tl::unexpected(os_fault("opening a UDP socket", errno));
    if (auto done = configure(); !done) {
      close();
      return done;
    }
    return {};
  }

  void close() override {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    for (const int fd : further_) ::close(fd);
    further_.clear();
    joined_.clear();
  }

  bool is_open() const override { return fd_ >= 0; }

  Result<void> send(const SocketAddress& to, std::span<const std::uint8_t> bytes) override {
    const sockaddr_in address = to_sockaddr(to);
    // A pending error about an earlier datagram makes the next send fail without sending: take the error and retry.
    for (int attempt = 0;; ++attempt) {
      const auto sent = ::sendto(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
                                 reinterpret_cast<const sockaddr*>(&address), sizeof(address));
      if (sent == static_cast<ssize_t>(bytes.size())) return {};
      const int error = sent < 0 ? errno : EMSGSIZE;
      if (attempt == 0 && (error == ECONNREFUSED || error == EHOSTUNREACH)) continue;
      return tl::unexpected(os_fault("sending to " + text_of(to), error));
    }
  }

  Result<void> join(std::uint32_t group) override {
    if (joined_.contains(group)) return {};
    auto request = interface_request();
    if (!request) return tl::unexpected(request.error());
    request->imr_multiaddr.s_addr = htonl(group);
    const auto add = [&](int fd) {
      return ::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &*request, sizeof(*request)) == 0;
    };
    const int last = further_.empty() ? fd_ : further_.back();
    bool added = add(last);
    // A socket can join only so many groups (net.ipv4.igmp_max_memberships, 20). Further groups use another socket.
    if (!added && errno == ENOBUFS) {
      if (auto opened = open_another(); !opened) return opened;
      added = add(further_.back());
    }
    if (!added) return tl::unexpected(os_fault("joining the group " + text_of(group), errno));
    joined_.insert(group);
    return {};
  }

  std::optional<Fault> take_error() override {
    // IP_RECVERR keeps each ICMP error with its destination address, although the socket is not connected.
    std::array<std::uint8_t, 8> payload{};
    std::array<std::uint8_t, 512> control{};
    sockaddr_in about{};
    iovec part{payload.data(), payload.size()};
    msghdr message{};
    message.msg_name = &about;
    message.msg_namelen = sizeof(about);
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    if (::recvmsg(fd_, &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) return std::nullopt;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != IPPROTO_IP || c->cmsg_type != IP_RECVERR) continue;
      sock_extended_err error{};
      std::memcpy(&error, CMSG_DATA(c), sizeof(error));
      return os_fault("a packet to " + text_of(from_sockaddr(about)), static_cast<int>(error.ee_errno));
    }
    return std::nullopt;
  }

  std::optional<Datagram> receive() override {
    if (auto datagram = receive_by(fd_)) return datagram;
    for (const int fd : further_) {
      if (auto datagram = receive_by(fd)) return datagram;
    }
    return std::nullopt;
  }

 private:
  static std::optional<Datagram> receive_by(int fd) {
    // Twice, since a pending error is reported once in place of the next datagram.
    for (int attempt = 0; attempt < 2; ++attempt) {
      std::array<std::uint8_t, 2048> buffer{};
      sockaddr_in from{};
      socklen_t size = sizeof(from);
      const auto got = ::recvfrom(fd, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (got >= 0) return Datagram{from_sockaddr(from), {buffer.begin(), buffer.begin() + got}};
    }
    return std::nullopt;
  }

  Result<void> open_another() {
    const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) return tl::unexpected(os_fault("opening a UDP socket", errno));
    further_.push_back(fd);
    const int yes = 1, no = 0;
    const sockaddr_in local = to_sockaddr({INADDR_ANY, settings_.local_port});
    if (::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) != 0 ||
        ::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_ALL, &no, sizeof(no)) != 0 ||
        ::bind(fd, reinterpret_cast<const sockaddr*>(&local), sizeof(local)) != 0) {
      return tl::unexpected(os_fault("listening on UDP port " + std::to_string(settings_.local_port), errno));
    }
    return {};
  }

  /// The interface of the settings; unspecified if they name none.
  Result<ip_mreqn> interface_request() const {
    ip_mreqn request{};
    if (settings_.multicast_interface.empty()) return request;
    if (const auto address = parse_ipv4(settings_.multicast_interface)) {
      request.imr_address.s_addr = htonl(*address);
      return request;
    }
    request.imr_ifindex = static_cast<int>(::if_nametoindex(settings_.multicast_interface.c_str()));
    if (request.imr_ifindex != 0) return request;
    return tl::unexpected(os_fault("looking up the interface \"" + settings_.multicast_interface + "\"", errno));
  }

  Result<void> set(int level, int option, int value, const char* doing) const {
    if (::setsockopt(fd_, level, option, &value, sizeof(value)) == 0) return {};
    return tl::unexpected(os_fault(doing, errno));
  }

  Result<void> configure() const {
    if (auto done = set(IPPROTO_IP, IP_RECVERR, 1, "asking for network errors"); !done) return done;
    if (auto done = set(IPPROTO_IP, IP_MULTICAST_TTL, settings_.multicast_ttl, "setting the multicast TTL"); !done) {
      return done;
    }
    if (settings_.broadcast) {
      if (auto done = set(SOL_SOCKET, SO_BROADCAST, 1, "asking to broadcast"); !done) return done;
    }
    if (settings_.share_local_port) {
      if (auto done = set(SOL_SOCKET, SO_REUSEADDR, 1, "sharing the local port"); !done) return done;
    }
    if (!settings_.multicast_interface.empty()) {
      const auto request = interface_request();
      if (!request) return tl::unexpected(request.error());
      if (::setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_IF, &*request, sizeof(*request)) != 0) {
        return tl::unexpected(os_fault("using the interface \"" + settings_.multicast_interface + "\"", errno));
      }
    }
    if (settings_.local_port != 0) {
      // Only groups joined here. Otherwise this socket also gets groups that another program of this host has joined.
      if (auto done = set(IPPROTO_IP, IP_MULTICAST_ALL, 0, "limiting multicast to its groups"); !done) return done;
      const sockaddr_in local = to_sockaddr({INADDR_ANY, settings_.local_port});
      if (::bind(fd_, reinterpret_cast<const sockaddr*>(&local), sizeof(local)) != 0) {
        return tl::unexpected(os_fault("listening on UDP port " + std::to_string(settings_.local_port), errno));
      }
    }
    return {};
  }

  UdpSettings settings_;
  int fd_ = -1;
  std::vector<int> further_;  ///< sockets for groups beyond the limit of one socket
  std::set<std::uint32_t> joined_;
};

}  // namespace

std::optional<std::uint32_t> parse_ipv4(std::string_view text) {
  in_addr address{};
  if (::inet_pton(AF_INET, std::string(text).c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

std::string text_of(std::uint32_t ipv4) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) {
    out += std::to_string((ipv4 >> shift) & 0xFF);
    if (shift > 0) out += '.';
  }
  return out;
}

std::string text_of(const SocketAddress& address) { return text_of(address.ipv4) + ":" + std::to_string(address.port); }

std::uint32_t local_address_towards(std::uint32_t ipv4) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  // Connecting a UDP socket only looks up the route.
  const sockaddr_in to = to_sockaddr({ipv4, 9});
  sockaddr_in local{};
  socklen_t size = sizeof(local);
  const bool known = ::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0 &&
                     ::getsockname(fd, reinterpret_cast<sockaddr*>(&local), &size) == 0;
  ::close(fd);
  return known ? from_sockaddr(local).ipv4 : 0;
}

std::unique_ptr<DatagramChannel> make_udp(UdpSettings settings) { return std::make_unique<Udp>(std::move(settings)); }

}  // namespace luxrig
