#pragma once
/// A DMX fixture with a maker's file reads its slots by the functions that the file states for their values, whatever
/// the driver's intention.
///
/// Its lamp burns while it is commanded on. A shutter that is not open is dark, and so is a strobe; a wheel changes no
/// light. Without emitters in the rig file the light is the mean of its colours, or of its cells.

#include <span>

#include "sim/devices/dmx_fixture.h"

namespace luxrig::sim {

/// requires fixture.mode. `slots`: the universe, address 1 first. A patch that extends past it reads 0 there.
[[nodiscard]] DmxOrder decode_personality(const Fixture& fixture, const DmxPatch& patch,
                                          std::span<const std::uint8_t, kDmxSlots> slots);

}  // namespace luxrig::sim
