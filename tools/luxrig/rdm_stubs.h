#pragma once
/// Devices found by RDM, as the beginning of a rig file.

#include <string>
#include <vector>

#include "drivers/dmx/rdm/rdm_profile.h"

namespace luxrig {

struct PatchedDevice {
  int universe = 0;
  rdm::DeviceProfile profile;
};

/// Names of slots as in a rig file, from the device's own description of its slots. Slots that Luxrig does not drive
/// are "unused". Empty when the device gave no description.
[[nodiscard]] std::vector<std::string> slot_names(const rdm::DeviceProfile& profile);

/// A [[fixture]] for each device that has slots. Lines with FILL IN need a person. Names are made unique.
[[nodiscard]] std::string fixture_stubs(const std::vector<PatchedDevice>& devices);

}  // namespace luxrig
