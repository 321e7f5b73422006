#pragma once
/// Addresses as a technician writes them.

#include <string>

#include "core/rig/rig.h"

namespace luxrig {

/// Address on its bus: "1.3-4" (DMX: universe and slots), "unit 10 register 2"; for a head on axes, their addresses
/// too.
[[nodiscard]] std::string fixture_address(const Rig& rig, const Fixture& fixture);
/// Address on its bus: "unit 21 register 2".
[[nodiscard]] std::string meter_address(const Luxmeter& meter);
/// Address of the bus itself: "192.0.2.10:502", "multicast", "/dev/ttyUSB0"; empty if its options name none.
[[nodiscard]] std::string bus_address(const Bus& bus);

}  // namespace luxrig
