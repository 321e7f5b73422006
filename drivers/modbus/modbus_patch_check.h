#pragma once
/// What a Modbus bus can carry, checked before anything is opened.

#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct ModbusLineRules {
  int first_unit = 0, last_unit = 255;
  std::optional<int> baud;  ///< of a serial line; nothing: not known here
  Duration refresh{};       ///< how often an unchanged level is written
};

/// Appends what is wrong with the fixtures and luxmeters on the bus.
void check_modbus_patches(const Rig& rig, std::size_t bus, const ModbusLineRules& rules,
                          std::vector<Problem>& problems);

}  // namespace luxrig
