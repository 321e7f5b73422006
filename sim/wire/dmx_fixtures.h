#pragma once
/// Fixtures at the end of a DMX line, by whichever protocol the packets came.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "sim/devices/dmx_fixture.h"
#include "sim/wire/bus_endpoint.h"

namespace luxrig::sim {

/// Levels of a universe, address 1 first; empty while it is not sent: its fixtures hold.
using DmxLevelsOf = std::function<std::optional<std::array<std::uint8_t, kDmxSlots>>(int universe)>;

/// Offset in slots from the fixture's patched address: RDM may have moved it.
using DmxMovedBy = std::function<int(std::size_t fixture)>;

/// Each fixture of the bus that receives follows its slots. `frame`: a different number each time, for random faults.
void obey_dmx(const EndpointParts& parts, std::uint64_t frame, const DmxLevelsOf& levels_of,
              const DmxMovedBy& moved_by = {});

}  // namespace luxrig::sim
