#pragma once
/// The DMX lines that RDM can reach, behind Art-Net nodes or a USB widget. Waits in real time.

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "drivers/dmx/artnet/artnet_rdm.h"
#include "drivers/dmx/rdm/rdm_client.h"
#include "drivers/registry.h"

namespace luxrig {

struct RdmSearch {
  SocketAddress poll_to;        ///< a node, or a broadcast address
  bool one_node = false;        ///< `poll_to` is a node
  std::optional<int> universe;  ///< only this one; none = all
  double seconds = 3;           ///< for the tables of devices, once nodes have been found
  bool rediscover = false;      ///< have the nodes search their lines again
};

/// A plugged-in widget, or (with a server) one behind USB/IP.
struct RdmWidgetSearch {
  std::string serial, port;  ///< as in UsbSearch; empty: any
  std::optional<Redirect> server;
  int universe = 1;  ///< the number given to its line
};

/// One line, and the devices that its node reports on it.
struct RdmUniverse {
  std::string node;  ///< its name
  int universe = 0;
  std::unique_ptr<rdm::RdmLink> link;
  std::unique_ptr<rdm::Client> client;
  std::set<rdm::Uid> uids;  ///< devices on the line
  bool complete = true;     ///< else there may be more devices
};

class RdmBus {
 public:
  /// Fault system or network when no port can be opened. Finding no node or no device is no fault.
  static Result<RdmBus> find(const RdmSearch& search);
  /// Searches the line of a widget. Faults as WidgetRdm::open.
  static Result<RdmBus> find(const RdmWidgetSearch& search);

  [[nodiscard]] std::size_t nodes() const { return nodes_; }  ///< or widgets
  [[nodiscard]] const std::vector<RdmUniverse>& universes() const { return universes_; }
  /// The line of this device; null if it is on none.
  [[nodiscard]] const RdmUniverse* line_of(const rdm::Uid& uid) const;
  /// Asks one question. Returns when it is answered or given up.
  [[nodiscard]] static Result<std::vector<std::uint8_t>> ask(const RdmUniverse& universe, const rdm::Request& request);

 private:
  struct NodeLine {
    std::string node;
    std::unique_ptr<artnet::ArtnetRdmLink> link;
  };
  Result<std::vector<NodeLine>> find_nodes(const RdmSearch& search);
  Result<void> read_tables(const RdmSearch& search, std::span<const NodeLine> lines);

  std::unique_ptr<DatagramChannel> channel_;
  std::vector<RdmUniverse> universes_;
  std::size_t nodes_ = 0;
};

}  // namespace luxrig
