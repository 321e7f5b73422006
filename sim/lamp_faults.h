#pragma once
/// Lamps that give no light whatever their level: burnt out (fault lamp_failure), or without power (unpowered).

#include <optional>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class LampFaults {
 public:
  /// For the fixtures of this bus; empty = of all. Call it before levels are applied; cheap while no fault changes. A
  /// device that loses power forgets its level.
  void obey(const Rig& rig, std::optional<std::size_t> bus, const Faults& faults, World& world) {
    if (faults.revision() == seen_) return;
    seen_ = faults.revision();
    unpowered_.resize(rig.fixtures.size(), false);
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
      const Fixture& fixture = rig.fixtures[f];
      if (bus && fixture.bus != *bus) continue;
      const bool unpowered = faults.find(fixture.name, FaultKind::unpowered).has_value();
      if (unpowered && !unpowered_[f]) world.set_drive(f, 0);
      unpowered_[f] = unpowered;
      world.set_lamp_out(f, unpowered || faults.find(fixture.name, FaultKind::lamp_failure));
    }
  }

 private:
  std::uint64_t seen_ = 0;
  std::vector<bool> unpowered_;
};

}  // namespace luxrig::sim
