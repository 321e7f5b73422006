#pragma once
/// Identity and settings of one device, read parameter by parameter.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/rdm/rdm_transaction.h"
#include "drivers/dmx/rdm/rdm_values.h"

namespace luxrig::rdm {

struct SensorState {
  SensorDefinition definition;
  std::optional<SensorValue> value;  ///< empty = it cannot be read now
};

struct DeviceProfile {
  Uid uid;
  DeviceInfo info;
  std::string manufacturer, model, label, software;  ///< empty = not reported
  std::optional<PersonalityDescription> personality;
  std::vector<SlotInfo> slots;       ///< empty = not reported
  std::vector<SensorState> sensors;  ///< the first 16
  std::optional<std::uint32_t> lamp_hours, device_hours;
  std::optional<LampState> lamp;
};

/// Sends one request and returns the data of the answer.
using Ask = std::function<Result<std::vector<std::uint8_t>>(const Request&)>;

/// DEVICE_INFO must be answered. Of the rest, it reads what the device lists and answers. A device that no longer
/// answers ends it with a fault.
[[nodiscard]] Result<DeviceProfile> read_profile(const Ask& ask, const Uid& uid);

}  // namespace luxrig::rdm
