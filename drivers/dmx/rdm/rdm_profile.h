#pragma once
/// What one device is and how it is set, read parameter by parameter.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/rdm/rdm_transaction.h"
#include "drivers/dmx/rdm/rdm_values.h"

namespace luxrig::rdm {

struct SensorState {
  SensorDefinition definition;
  std::optional<SensorValue> value;  ///< nothing: it cannot be read now
};

struct DeviceProfile {
  Uid uid;
  DeviceInfo info;
  std::string manufacturer, model, label, software;  ///< empty: not told
  std::optional<PersonalityDescription> personality;
  std::vector<SlotInfo> slots;       ///< empty: not told
  std::vector<SensorState> sensors;  ///< the first 16
  std::optional<std::uint32_t> lamp_hours, device_hours;
  std::optional<LampState> lamp;
};

/// Asks one question and returns the data of the answer.
using Ask = std::function<Result<std::vector<std::uint8_t>>(const Request&)>;

/// DEVICE_INFO must be answered; of everything else, what the device says it has and does answer. A device that says
/// nothing at all any more ends it.
[[nodiscard]] Result<DeviceProfile> read_profile(const Ask& ask, const Uid& uid);

}  // namespace luxrig::rdm
