#pragma once
/// The real datagram channel: one non-blocking IPv4 UDP socket.

#include <memory>

#include "drivers/io/datagram.h"

namespace luxrig {

struct UdpSettings {
  std::uint16_t local_port = 0;     ///< 0: any
  bool share_local_port = false;    ///< SO_REUSEADDR: other programs of this host may listen there as well
  bool broadcast = false;           ///< may send to broadcast addresses
  int multicast_ttl = 8;            ///< 1…255 hops; E1.31 asks for at most 8 unless told otherwise
  std::string multicast_interface;  ///< name ("eth0") or IPv4 address; empty: the system's choice
};

[[nodiscard]] std::unique_ptr<DatagramChannel> make_udp(UdpSettings settings);

}  // namespace luxrig
