#pragma once
/// Fixtures at the end of a DMX line, however the packets came there.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "sim/devices/dmx_fixture.h"
#include "sim/wire/bus_endpoint.h"

namespace luxrig::sim {

/// Levels of a universe, address 1 first; nothing while nobody sends it: its fixtures hold.
using DmxLevelsOf = std::function<std::optional<std::array<std::uint8_t, kDmxSlots>>(int universe)>;

/// By how many slots a fixture listens elsewhere than where it is patched: RDM may have moved it.
using DmxMovedBy = std::function<int(std::size_t fixture)>;

/// Each fixture of the bus that hears does as its slots say. `frame`: another number each time, for faults at random.
void obey_dmx(const EndpointParts& parts, std::uint64_t frame, const DmxLevelsOf& levels_of,
              const DmxMovedBy& moved_by = {});

}  // namespace luxrig::sim
