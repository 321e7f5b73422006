#pragma once
/// From a captured packet to the datagram, TCP segment or CAN frame in it. Pure; any bytes are allowed.
///
/// Sources: RFC 791, 768, 9293; IEEE 802.1Q; tcpdump.org/linktypes for the headers that captures begin with.

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "drivers/can/can_frame.h"
#include "drivers/io/datagram.h"

namespace luxrig::recording {

/// What the packets of a file begin with.
enum class LinkType { ethernet, raw_ip, null_host_order, loop, linux_sll, linux_sll2, can };
/// By libpcap's number (DLT_…); none: not known here.
[[nodiscard]] std::optional<LinkType> link_type_of(int dlt);

struct UdpDatagram {
  SocketAddress from, to;
  std::span<const std::uint8_t> payload;
};
struct TcpSegment {
  SocketAddress from, to;
  std::uint32_t sequence = 0;  ///< of the first byte of the payload
  bool begins = false;         ///< SYN
  std::span<const std::uint8_t> payload;
};
struct Seen {
  /// monostate: something else (IPv6, ARP, a fragment), or not well formed.
  std::variant<std::monostate, UdpDatagram, TcpSegment, can::CanFrame> what;
  bool cut = false;        ///< the capture has left out the end of this datagram or segment
  bool sent_here = false;  ///< by the computer that captured
};
[[nodiscard]] Seen look_into(LinkType link, std::span<const std::uint8_t> packet);

}  // namespace luxrig::recording
