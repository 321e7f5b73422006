#pragma once
/// The DMX fixtures of one bus as RDM responders, one line for each universe. All parts of one housing form one
/// responder, named after the first. UIDs are from the range for prototypes (manufacturer 0x7FF0).

#include <map>
#include <optional>
#include <vector>

#include "sim/devices/rdm_line.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class RdmFixtures {
 public:
  /// All arguments outlive it.
  RdmFixtures(const Rig& rig, std::size_t bus, const World& world, const Faults& faults);

  /// Universe -> its line.
  [[nodiscard]] std::map<int, RdmLine>& lines() { return lines_; }
  /// Offset in slots of a fixture's start address from the rig file's.
  [[nodiscard]] int moved_by(std::size_t fixture) const;
  /// Warms the housings by their lamps.
  void shine(Time now);

 private:
  struct Housing {
    RdmResponder* responder;
    int patched_address;
  };

  const World& world_;
  std::map<int, RdmLine> lines_;
  std::map<std::size_t, Housing> housings_;             ///< by their first fixture
  std::vector<std::optional<std::size_t>> housing_of_;  ///< by fixture
};

}  // namespace luxrig::sim
