#pragma once
/// Loopback sockets that never block. The simulator listens on no other address.

#include <cstdint>
#include <utility>

#include "core/result.h"

namespace luxrig::sim {

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

/// Bound to 127.0.0.1; port 0 = any free one. Cause::system with the port and the system's message.
[[nodiscard]] Result<BoundSocket> bind_udp(int port);
[[nodiscard]] Result<BoundSocket> listen_tcp(int port);

}  // namespace luxrig::sim
