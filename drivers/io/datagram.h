#pragma once
/// Datagrams in and out, never blocking. udp.h has the real channel; tests use a scripted one.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// An IPv4 address and port, both in host byte order.
struct SocketAddress {
  std::uint32_t ipv4 = 0;
  std::uint16_t port = 0;
  friend auto operator<=>(const SocketAddress&, const SocketAddress&) = default;
};

/// "10.0.0.7" -> 0x0A000007. Numbers only: a name would need a resolver, and a resolver may block.
[[nodiscard]] std::optional<std::uint32_t> parse_ipv4(std::string_view text);
[[nodiscard]] std::string text_of(std::uint32_t ipv4);
[[nodiscard]] std::string text_of(const SocketAddress& address);  ///< "10.0.0.7:5568"
[[nodiscard]] inline bool is_multicast(std::uint32_t ipv4) { return (ipv4 >> 28) == 0xE; }

struct Datagram {
  SocketAddress from;
  std::vector<std::uint8_t> bytes;
};

class DatagramChannel {
 public:
  virtual ~DatagramChannel() = default;

  /// Idempotent. Fault system or network, with the failed call and the operating system's message.
  virtual Result<void> open() = 0;
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;

  /// Hands one datagram to the network. Success says nothing about arrival.
  virtual Result<void> send(const SocketAddress& to, std::span<const std::uint8_t> bytes) = 0;

  /// Receives from a multicast group until closed. Idempotent.
  virtual Result<void> join(std::uint32_t group) = 0;

  /// Network errors about earlier datagrams (port closed, host unreachable), oldest first, each once.
  virtual std::optional<Fault> take_error() = 0;

  /// The next datagram that has arrived, if any.
  virtual std::optional<Datagram> receive() = 0;
};

}  // namespace luxrig
