#include "drivers/modbus/modbus_registers.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig::modbus {

constexpr double kBeyondFullScale = 1.05;

std::uint16_t raw_from_drive(double drive, int full_scale_raw) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(drive, 0.0, 1.0) * full_scale_raw));
}

double lux_from_registers(const ModbusMeterPatch& patch, std::span<const std::uint16_t> raw) {
  LUXRIG_CHECK(raw.size() == static_cast<std::size_t>(patch.registers) && (raw.size() == 1 || raw.size() == 2),
               "{} registers, {} expected", raw.size(), patch.registers);
  std::uint32_t count = raw[0];
  if (raw.size() == 2) {
    const std::uint32_t high = patch.low_word_first ? raw[1] : raw[0];
    const std::uint32_t low = patch.low_word_first ? raw[0] : raw[1];
    count = high << 16 | low;
  }
  return patch.lux_per_count * static_cast<double>(count);
}

std::optional<double> plausible_lux(double lux, double range_lx) {
  if (!(lux >= 0 && lux <= range_lx * kBeyondFullScale)) return std::nullopt;
  return std::min(lux, range_lx);
}

}  // namespace luxrig::modbus
