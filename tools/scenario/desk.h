#pragma once
/// Whether a bus of the rig file listens to a lighting desk, and by which rules.

#include <optional>

#include "core/output/devices.h"
#include "core/rig/patch.h"
#include "drivers/dmx/desk_options.h"
#include "drivers/registry.h"

namespace luxrig::scenario {

/// nullopt: it does not listen, or its driver cannot. requires a rig whose bus options were checked.
[[nodiscard]] inline std::optional<DeskRules> desk_rules(const Bus& bus) {
  const DriverEntry* driver = find_driver(bus.driver);
  if (driver == nullptr) return std::nullopt;
  for (const OptionDoc& option : driver->options)
    if (option.key == kInputOption.key) return desk_options(bus, driver->options).rules;
  return std::nullopt;
}

}  // namespace luxrig::scenario
