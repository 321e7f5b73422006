#pragma once
/// The real datagram channel: one non-blocking IPv4 UDP socket.

#include <memory>

#include "drivers/io/datagram.h"

namespace luxrig {

struct UdpSettings {
  std::uint16_t local_port = 0;     ///< 0 = any
  bool share_local_port = false;    ///< SO_REUSEADDR: other programs of this host may listen on it as well
  bool broadcast = false;           ///< may send to broadcast addresses
  int multicast_ttl = 8;            ///< 1…255 hops; E1.31 asks for at most 8 by default
  std::string multicast_interface;  ///< name ("eth0") or IPv4 address, to send and join by; empty = the system chooses
};

/// This host's source address for packets to `ipv4`; 0 if there is no route. Sends nothing.
[[nodiscard]] std::uint32_t local_address_towards(std::uint32_t ipv4);

[[nodiscard]] std::unique_ptr<DatagramChannel> make_udp(UdpSettings settings);

}  // namespace luxrig
