#pragma once
/// What was found by RDM, as the beginning of a rig file.

#include <string>
#include <vector>

#include "drivers/dmx/rdm/rdm_profile.h"

namespace luxrig {

struct PatchedDevice {
  int universe = 0;
  rdm::DeviceProfile profile;
};

/// Names of slots as a rig file has them, from what the device says its slots are; "unused" for all that Luxrig does
/// not drive. Empty when the device did not say.
[[nodiscard]] std::vector<std::string> slot_names(const rdm::DeviceProfile& profile);

/// A [[fixture]] for each device that has slots; lines with FILL IN need a person. Names are made unique.
[[nodiscard]] std::string fixture_stubs(const std::vector<PatchedDevice>& devices);

}  // namespace luxrig
