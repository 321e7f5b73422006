#include "drivers/modbus/modbus_registers.h"

#include <algorithm>
#include <cmath>

namespace luxrig::modbus {

constexpr double kBeyondFullScale = 1.05;

RegisterWords words_from_drive(double drive, const ModbusPatch& patch) {
  const double share = std::clamp(drive, 0.0, 1.0);
  if (patch.coil) return {{static_cast<std::uint16_t>(share >= kRelayOnFrom ? 1 : 0), 0}, 1};
  return words_of(patch.dark_raw + share * (patch.full_scale_raw - patch.dark_raw), patch.format);
}

RegisterWords words_from_drive(double drive, const ModbusPatch& patch, const std::optional<RegisterWords>& now) {
  if (patch.coil && now && drive < kRelayOnFrom && drive >= kRelayOffBelow) return *now;
  return words_from_drive(drive, patch);
}

double lux_from_registers(const ModbusMeterPatch& patch, std::span<const std::uint16_t> raw) {
  return patch.lux_per_count * value_of(raw, patch.format());
}

std::optional<double> plausible_lux(double lux, double range_lx) {
  if (!(lux >= 0 && lux <= range_lx * kBeyondFullScale)) return std::nullopt;
  return std::min(lux, range_lx);
}

}  // namespace luxrig::modbus
