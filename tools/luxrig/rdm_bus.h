#pragma once
/// The DMX lines that can be reached by RDM, behind Art-Net nodes. Waits in real time.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/artnet/artnet_rdm.h"
#include "drivers/dmx/rdm/rdm_client.h"

namespace luxrig {

struct RdmSearch {
  SocketAddress poll_to;        ///< a node, or where all are asked
  bool one_node = false;        ///< the former
  std::optional<int> universe;  ///< only this one
  double seconds = 3;           ///< for the tables of devices, after nodes have been found
  bool rediscover = false;      ///< have the nodes search their lines anew
};

/// One line, and what its node says is on it.
struct RdmUniverse {
  std::string node;  ///< its name
  std::unique_ptr<artnet::ArtnetRdmLink> link;
  std::unique_ptr<rdm::Client> client;
};

class RdmBus {
 public:
  /// Fault system or network when there is no port to be had; no node, no device is no fault.
  static Result<RdmBus> find(const RdmSearch& search);

  [[nodiscard]] std::size_t nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<RdmUniverse>& universes() const { return universes_; }
  /// The line on which this device is; null: on none.
  [[nodiscard]] const RdmUniverse* line_of(const rdm::Uid& uid) const;
  /// Asks one question; returns when it is answered, or given up.
  [[nodiscard]] static Result<std::vector<std::uint8_t>> ask(const RdmUniverse& universe, const rdm::Request& request);

 private:
  Result<void> find_nodes(const RdmSearch& search);
  Result<void> read_tables(const RdmSearch& search);

  std::unique_ptr<DatagramChannel> channel_;
  std::vector<RdmUniverse> universes_;
  std::size_t nodes_ = 0;
};

}  // namespace luxrig
