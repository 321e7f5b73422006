#pragma once
/// Behaviour of a dimmer behind Modbus when writes stop. The protocol does not define it; its product's register map
/// does.

#include "drivers/when_data_stops.h"

namespace luxrig {

[[nodiscard]] WhenDataStops modbus_when_data_stops(const Rig& rig, std::size_t fixture);

}  // namespace luxrig
