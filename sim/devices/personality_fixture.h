#pragma once
/// How a DMX fixture with a maker's file understands its slots: from the functions that the file states for the values
/// it finds, whatever a driver meant to send.
///
/// Its lamp burns while it is commanded on; a shutter that is not open, and a strobe, are dark; a wheel changes no
/// light. Without emitters in the rig file the light is the mean of its colours, or of its cells.

#include <span>

#include "sim/devices/dmx_fixture.h"

namespace luxrig::sim {

/// requires fixture.mode. `slots`: the universe, address 1 first. A patch that runs past it reads 0 there.
[[nodiscard]] DmxOrder decode_personality(const Fixture& fixture, const DmxPatch& patch,
                                          std::span<const std::uint8_t, kDmxSlots> slots);

}  // namespace luxrig::sim
