#pragma once
/// What a dimmer behind Modbus does when nobody writes any more. The protocol says nothing of that; its product's
/// register map does.

#include "drivers/when_data_stops.h"

namespace luxrig {

[[nodiscard]] WhenDataStops modbus_when_data_stops(const Rig& rig, std::size_t fixture);

}  // namespace luxrig
