#pragma once
/// A DMX fixture's reading of its slots: dimmer and joints, 8, 16 or 24 bit, and slots that must hold a constant; with
/// a maker's file, as in personality_fixture.h.
/// Source: ANSI E1.11 (addresses count from 1); physical = from + v/(2ⁿ − 1) · (to − from).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/rig/equipment.h"

namespace luxrig::sim {

inline constexpr std::size_t kDmxSlots = 512;

struct DmxOrder {
  double drive = 0;                  ///< 0 if a constant slot holds anything else: its shutter is shut or its lamp off
  std::optional<Joints> joints;      ///< if it has a pan and a tilt slot
  std::optional<double> beam_rad{};  ///< of a zoom slot, if its pan and tilt are axes elsewhere
};

/// `slots`: the universe, address 1 first. A patch that extends past it reads 0 there.
[[nodiscard]] DmxOrder decode_slots(const Fixture& fixture, const DmxPatch& patch,
                                    std::span<const std::uint8_t, kDmxSlots> slots);

}  // namespace luxrig::sim
