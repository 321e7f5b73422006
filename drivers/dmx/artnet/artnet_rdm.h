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

/// The devices on one port, as its node reports them.
struct TableOfDevices {
  std::set<rdm::Uid> uids;
  bool heard = false;     ///< an answer has come
  bool complete = false;  ///< all blocks have come, and the node had a table
};

class ArtnetRdmLink final : public rdm::RdmLink {
 public:
  /// The caller opens the channel; it outlives the link. `node`: destination of requests; packets from other IPv4
  /// addresses are ignored.
  ArtnetRdmLink(DatagramChannel& channel, SocketAddress node, int port_address);

  [[nodiscard]] const SocketAddress& node() const { return node_; }
  [[nodiscard]] int port_address() const { return port_address_; }

  /// Asks for the present table.
  Result<void> ask_table();
  /// Makes the node search the line again and forgets the known table. The node may report an empty table first.
  Result<void> flush_table();
  [[nodiscard]] const TableOfDevices& table() const { return table_; }

  /// Takes all received datagrams.
  void listen();
  /// The same, for a datagram taken off the channel elsewhere; false if it does not belong to this link.
  bool hear(const Datagram& datagram);

  Result<void> send(Time now, std::span<const std::uint8_t> packet) override;
  std::optional<std::vector<std::uint8_t>> receive(Time now) override;
  /// The line takes milliseconds, but nodes queue requests behind DMX and behind other controllers' requests.
  [[nodiscard]] Duration answer_within() const override { return std::chrono::milliseconds(800); }

 private:
  void take(const TodData& data);

  DatagramChannel& channel_;
  SocketAddress node_;
  int port_address_;
  TableOfDevices table_;
  int total_ = 0;
  std::map<int, std::vector<rdm::Uid>> blocks_;  ///< of the table being received
  std::deque<std::vector<std::uint8_t>> answers_;
};

}  // namespace luxrig::artnet
