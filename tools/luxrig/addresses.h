#pragma once
/// Addresses as a technician writes them.

#include <string>

#include "core/rig/rig.h"

namespace luxrig {

/// On its bus: "1.3-4" (DMX: universe and slots), "unit 10 register 2"; of a head on axes, those as well.
[[nodiscard]] std::string fixture_address(const Rig& rig, const Fixture& fixture);
/// On its bus: "unit 21 register 2".
[[nodiscard]] std::string meter_address(const Luxmeter& meter);
/// Of the bus itself: "192.0.2.10:502", "multicast", "/dev/ttyUSB0"; empty when its options name none.
[[nodiscard]] std::string bus_address(const Bus& bus);

}  // namespace luxrig
