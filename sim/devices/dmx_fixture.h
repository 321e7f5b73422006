#pragma once
/// How a DMX fixture understands its slots: dimmer and joints, 8, 16 or 24 bit, and slots that must hold a constant;
/// with a maker's file, as personality_fixture.h says.
/// Source: ANSI E1.11 (addresses count from 1); physical = from + v/(2ⁿ − 1) · (to − from).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/rig/rig.h"

namespace luxrig::sim {

inline constexpr std::size_t kDmxSlots = 512;

struct DmxOrder {
  double drive = 0;              ///< 0 while a constant slot holds anything else: its shutter is shut, its lamp is off
  std::optional<Joints> joints;  ///< when it has a pan and a tilt slot
  std::optional<double> beam_rad{};  ///< of a zoom slot, when its pan and tilt are axes elsewhere
};

/// `slots`: the universe, address 1 first. A patch that runs past it reads 0 there.
[[nodiscard]] DmxOrder decode_slots(const Fixture& fixture, const DmxPatch& patch,
                                    std::span<const std::uint8_t, kDmxSlots> slots);

}  // namespace luxrig::sim
