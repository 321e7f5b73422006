#pragma once
/// Sockets that never block, on one IPv4 address: 127.0.0.1 unless told otherwise.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace luxrig::sim {

/// IPv4 addresses are in host order.
inline constexpr std::uint32_t kAnyAddress = 0, kLoopback = 0x7f000001;

[[nodiscard]] std::string address_text(std::uint32_t address);

/// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { reset(); }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool open() const { return fd_ >= 0; }
  void reset();

 private:
  int fd_ = -1;
};

struct BoundSocket {
  Descriptor descriptor;
  int port = 0;
};

/// Port 0 = any free one. Cause::system with address, port, the system's message and a mend.
[[nodiscard]] Result<BoundSocket> bind_udp(int port, std::uint32_t address = kLoopback);
[[nodiscard]] Result<BoundSocket> listen_tcp(int port, std::uint32_t address = kLoopback);

/// As bind_udp, for a port that other programs on this machine use as well, such as a desk that receives on all
/// addresses.
[[nodiscard]] Result<BoundSocket> share_udp(int port, std::uint32_t address);
/// Two simulators that share a port would take each other's packets. Holds the port against other simulators of this
/// machine. Cause::system if one has it.
[[nodiscard]] Result<Descriptor> claim_udp(int port, std::uint32_t address);
/// What is sent to `group` by multicast, on the networks of `address` (kAnyAddress: on all).
[[nodiscard]] Result<Descriptor> join_multicast(int port, std::uint32_t group, std::uint32_t address);
/// What is sent by broadcast on the network of `address`: to the network's broadcast address, and to 255.255.255.255.
/// Empty if it has none, and for kAnyAddress, as a socket bound to that receives broadcasts itself.
[[nodiscard]] Result<std::vector<Descriptor>> hear_broadcasts(int port, std::uint32_t address);

/// The address of this machine from which packets go to `peer`; kLoopback if there is no route.
[[nodiscard]] std::uint32_t own_address_towards(std::uint32_t peer);
/// The system lets this process listen on the port, be it free or taken.
[[nodiscard]] bool may_listen_on(int port);

}  // namespace luxrig::sim
