#pragma once
/// The RDM half of an Art-Net node: tables of devices, and RDM packets to and from the lines behind its ports. Pure.
/// Source: Art-Net 4 specification: ArtTodRequest, ArtTodControl, ArtTodData, ArtRdm.
///
/// A flush rebuilds the table from the devices reachable then. Between flushes it stays, whichever devices come or go.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sim/devices/rdm_line.h"

namespace luxrig::sim {

class ArtnetRdmGate {
 public:
  /// Port address -> line. The map outlives it.
  explicit ArtnetRdmGate(std::map<int, RdmLine>& lines);

  struct Answer {
    std::vector<std::uint8_t> packet;
    Duration late{};
  };
  /// Answers to the sender; none unless it is one of the three requests.
  std::vector<Answer> receive(Time now, std::span<const std::uint8_t> packet);

 private:
  struct Port {
    RdmLine* line = nullptr;
    std::vector<std::uint64_t> table;
    int number = 1, bind_index = 1;  ///< as in the node's ArtPollReply
  };
  void tell_table(int port_address, const Port& port, std::vector<Answer>& answers) const;

  std::map<int, Port> ports_;
};

}  // namespace luxrig::sim
