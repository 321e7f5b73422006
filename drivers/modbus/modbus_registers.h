#pragma once
/// Register values <-> drives and lux. Pure.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/rig/patch.h"
#include "core/rig/register_map/register_value.h"

namespace luxrig::modbus {

/// Register words of a dimmer for a drive of 0…1: the nearest value of dark_raw…full_scale_raw; of a coil 0 or 1.
[[nodiscard]] RegisterWords words_from_drive(double drive, const ModbusPatch& patch);

/// Hysteresis of a relay, so a drive that wanders about one half does not wear it out.
inline constexpr double kRelayOnFrom = 0.5, kRelayOffBelow = 0.4;

/// The same, given the present words `now`: a coil keeps its state between the two thresholds.
[[nodiscard]] RegisterWords words_from_drive(double drive, const ModbusPatch& patch,
                                             const std::optional<RegisterWords>& now);

/// The lux of a meter's registers, exact for all whole numbers. May be negative, or not finite.
/// requires raw.size() == patch.registers (1 or 2).
[[nodiscard]] double lux_from_registers(const ModbusMeterPatch& patch, std::span<const std::uint16_t> raw);

/// The light of a plausible reading. Up to 5 % over full scale it counts as full scale (instruments clip there, and
/// their own gain error may exceed it). Empty beyond that: broken sensors show 0xFFFF….
[[nodiscard]] std::optional<double> plausible_lux(double lux, double range_lx);

}  // namespace luxrig::modbus
