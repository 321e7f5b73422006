#pragma once
/// RDM to the DMX line behind one port of one Art-Net node: its table of devices, and a link for rdm::Client. The node
/// itself searches the line for devices.

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "drivers/dmx/artnet/artnet_rdm_codec.h"
#include "drivers/dmx/rdm/rdm_client.h"
#include "drivers/io/datagram.h"

namespace luxrig::artnet {

/// What a node has told about the devices on one of its ports.
struct TableOfDevices {
  std::set<rdm::Uid> uids;
  bool heard = false;     ///< some answer has come
  bool complete = false;  ///< all blocks have, and the node had a table
};

class ArtnetRdmLink final : public rdm::RdmLink {
 public:
  /// The channel is opened by the caller, and outlives the link. `node`: where requests go; what comes from another
  /// IPv4 address is not listened to.
  ArtnetRdmLink(DatagramChannel& channel, SocketAddress node, int port_address);

  [[nodiscard]] const SocketAddress& node() const { return node_; }
  [[nodiscard]] int port_address() const { return port_address_; }

  /// Asks for the table as it is.
  Result<void> ask_table();
  /// Has the node search the line anew; what was known is forgotten. It may tell an empty table first.
  Result<void> flush_table();
  [[nodiscard]] const TableOfDevices& table() const { return table_; }

  /// Takes what has arrived.
  void listen();
  /// The same, of a datagram that somebody else has taken off the channel; false when it is none of this link's.
  bool hear(const Datagram& datagram);

  Result<void> send(Time now, std::span<const std::uint8_t> packet) override;
  std::optional<std::vector<std::uint8_t>> receive(Time now) override;
  /// The line takes milliseconds; nodes let requests wait behind DMX and behind other controllers'.
  [[nodiscard]] Duration answer_within() const override { return std::chrono::milliseconds(800); }

 private:
  void take(const TodData& data);

  DatagramChannel& channel_;
  SocketAddress node_;
  int port_address_;
  TableOfDevices table_;
  int total_ = 0;
  std::map<int, std::vector<rdm::Uid>> blocks_;  ///< of the table that is being told
  std::deque<std::vector<std::uint8_t>> answers_;
};

}  // namespace luxrig::artnet
