#pragma once
/// Limits of a Modbus bus, checked before anything is opened.

#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct ModbusLineRules {
  int first_unit = 0, last_unit = 255;
  std::optional<int> baud;  ///< of a serial line; empty = unknown
  Duration refresh{};       ///< how often an unchanged level is written
};

/// Appends the problems of the bus's fixtures and luxmeters.
void check_modbus_patches(const Rig& rig, std::size_t bus, const ModbusLineRules& rules,
                          std::vector<Problem>& problems);

}  // namespace luxrig
