#pragma once
/// The DMX lines that can be reached by RDM, behind Art-Net nodes or a USB widget. Waits in real time.

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
  SocketAddress poll_to;        ///< a node, or where all are asked
  bool one_node = false;        ///< the former
  std::optional<int> universe;  ///< only this one
  double seconds = 3;           ///< for the tables of devices, after nodes have been found
  bool rediscover = false;      ///< have the nodes search their lines anew
};

/// A widget that is plugged in, or (with a server) stands behind USB/IP.
struct RdmWidgetSearch {
  std::string serial, port;  ///< as UsbSearch has them; empty: any
  std::optional<Redirect> server;
  int universe = 1;  ///< what its line is called
};

/// One line, and what its node says is on it.
struct RdmUniverse {
  std::string node;  ///< its name
  int universe = 0;
  std::unique_ptr<rdm::RdmLink> link;
  std::unique_ptr<rdm::Client> client;
  std::set<rdm::Uid> uids;  ///< who is on it
  bool complete = true;     ///< else there may be more
};

class RdmBus {
 public:
  /// Fault system or network when there is no port to be had; no node, no device is no fault.
  static Result<RdmBus> find(const RdmSearch& search);
  /// Searches the line of a widget. Faults as WidgetRdm::open.
  static Result<RdmBus> find(const RdmWidgetSearch& search);

  [[nodiscard]] std::size_t nodes() const { return nodes_; }  ///< or widgets
  [[nodiscard]] const std::vector<RdmUniverse>& universes() const { return universes_; }
  /// The line on which this device is; null: on none.
  [[nodiscard]] const RdmUniverse* line_of(const rdm::Uid& uid) const;
  /// Asks one question; returns when it is answered, or given up.
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
