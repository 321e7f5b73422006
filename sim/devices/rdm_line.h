#pragma once
/// RDM responders on one DMX pair: who answers at once with others is not understood. Pure.
///
/// Faults of a fixture, as sim/faults has them: lost, silent, dead and unpowered: no answer; garbled: a byte of its
/// answer is another; slow: late. Where several answer, their bits add up, as open-collector lines do.

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

  /// `name`: whose faults it has.
  RdmResponder& add(std::string name, RdmIdentity identity);

  struct Answer {
    std::vector<std::uint8_t> bytes;  ///< from the start code on; empty: silence
    Duration late{};
  };
  /// A packet goes out on the line, from its start code on.
  Answer exchange(Time now, std::span<const std::uint8_t> packet);

  /// Who could be found on it now, ascending.
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
