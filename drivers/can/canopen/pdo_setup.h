#pragma once
/// The SDO writes that set up one process data object (CiA 301, 7.5.2.35 to 38), in the only order that nodes accept:
/// off, mapping cleared, entries, count, transmission, on. The node must be pre-operational. Pure.

#include <initializer_list>
#include <vector>

#include "drivers/can/canopen/sdo_client.h"

namespace luxrig::canopen {

struct MappedObject {
  ObjectAddress object;
  int bits = 0;
};

enum class PdoDirection { to_node, from_node };

/// A value as SDO bytes.
[[nodiscard]] std::vector<std::uint8_t> little_endian(std::uint32_t value, int bytes);

/// number        1…4
/// transmission  1…240: with every n-th SYNC; 254, 255: event-driven
/// requires at most 64 bits in all.
[[nodiscard]] std::vector<SdoRequest> pdo_setup(PdoDirection direction, int number, int node, int transmission,
                                                const std::vector<MappedObject>& mapped);
/// Turns an unwanted PDO off.
[[nodiscard]] SdoRequest pdo_off(PdoDirection direction, int number, int node);

}  // namespace luxrig::canopen
