#pragma once
/// Modbus TCP conversations put together again: the bytes of each direction in order, requests matched with answers by
/// transaction. Pure; any segments are allowed, lost and repeated ones too.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "tools/recording/link_layer.h"
#include "tools/recording/recording.h"

namespace luxrig::recording {

/// One direction of a connection.
class TcpStream {
 public:
  /// Takes a segment; in() may have more bytes then. A repeated part is left out. A segment that is ahead waits for
  /// the missing one; after kWait of them it counts as lost, and in() begins anew behind the gap.
  void take(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  [[nodiscard]] std::vector<std::uint8_t>& in() { return in_; }

  static constexpr std::size_t kWait = 4;

 private:
  void append(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  std::optional<std::uint32_t> next_;
  std::vector<std::uint8_t> in_;
  std::vector<std::pair<std::uint32_t, std::vector<std::uint8_t>>> ahead_;
};

/// A Modbus TCP request as it is on the wire; none: it is no request of a function known here.
[[nodiscard]] std::optional<modbus::Request> decode_request(std::span<const std::uint8_t> frame);

class ModbusStreams {
 public:
  explicit ModbusStreams(std::set<std::uint16_t> ports) : ports_(std::move(ports)) { ports_.insert(kModbusPort); }
  /// Whether the segment is of a Modbus server.
  [[nodiscard]] bool concerns(const TcpSegment& segment) const {
    return ports_.contains(segment.to.port) || ports_.contains(segment.from.port);
  }
  void take(Duration at, const TcpSegment& segment, Recording& into);
  /// Counts requests that nobody has answered.
  void end(Recording& into) const;

 private:
  static constexpr std::size_t kConnections = 256, kRequests = 64;
  struct Connection {
    TcpStream requests, answers;
    std::map<std::uint16_t, modbus::Request> waiting;  ///< by transaction
    std::uint64_t used = 0;
  };
  void take_answer(Duration at, const SocketAddress& server, Connection& connection,
                   std::span<const std::uint8_t> frame, Recording& into);

  std::set<std::uint16_t> ports_;
  std::map<std::pair<SocketAddress, SocketAddress>, Connection> connections_;  ///< client, server
  std::uint64_t uses_ = 0;
  std::size_t unanswered_ = 0;
};

}  // namespace luxrig::recording
