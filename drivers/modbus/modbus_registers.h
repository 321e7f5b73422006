#pragma once
/// Register values <-> drives and lux. Pure.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/rig/register_map/register_value.h"
#include "core/rig/rig.h"

namespace luxrig::modbus {

/// drive 0…1 to what goes into the registers of a dimmer: the nearest of dark_raw…full_scale_raw; of a coil 0 or 1.
[[nodiscard]] RegisterWords words_from_drive(double drive, const ModbusPatch& patch);

/// A relay is on or off: a drive that wanders about a half must not wear it out.
inline constexpr double kRelayOnFrom = 0.5, kRelayOffBelow = 0.4;

/// The same where `now` is there already: of a coil, between the two it stays as it is.
[[nodiscard]] RegisterWords words_from_drive(double drive, const ModbusPatch& patch,
                                             const std::optional<RegisterWords>& now);

/// The lux that a meter's registers stand for, exact for all whole numbers. May be negative, or not finite.
/// requires raw.size() == patch.registers (1 or 2).
[[nodiscard]] double lux_from_registers(const ModbusMeterPatch& patch, std::span<const std::uint16_t> raw);

/// What a reading says about the light: up to 5 % over full scale it is full scale (instruments clip there, and their
/// own gain error may carry them past it). Beyond, it is no reading: sensors show 0xFFFF… when they are broken.
[[nodiscard]] std::optional<double> plausible_lux(double lux, double range_lx);

}  // namespace luxrig::modbus
