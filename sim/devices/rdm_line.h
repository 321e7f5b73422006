#pragma once
/// RDM responders on one DMX pair; simultaneous answers collide. Pure.
///
/// Faults of a fixture as in sim/faults. lost, silent, dead and unpowered: no answer; garbled: one byte of its answer
/// is changed; slow: late. Simultaneous answers are ORed bit by bit, as on open-collector lines.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/devices/rdm_responder.h"
#include "sim/faults/faults.h"

namespace luxrig::sim {

class RdmLine {
 public:
  /// `faults` outlives it.
  explicit RdmLine(const Faults& faults) : faults_(faults) {}

  /// `name`: the device whose faults apply.
  RdmResponder& add(std::string name, RdmIdentity identity);

  struct Answer {
    std::vector<std::uint8_t> bytes;  ///< from the start code on; empty = silence
    Duration late{};
  };
  /// A packet goes out on the line, from its start code on.
  Answer exchange(Time now, std::span<const std::uint8_t> packet);

  /// UIDs that a search could find now, ascending.
  [[nodiscard]] std::vector<std::uint64_t> reachable() const;

 private:
  struct Member {
    std::string name;
    std::unique_ptr<RdmResponder> responder;
    bool had_power = true;
  };
  [[nodiscard]] bool dead(const Member& member) const;

  const Faults& faults_;
  std::vector<Member> members_;
  std::uint64_t exchanges_ = 0;
};

}  // namespace luxrig::sim
