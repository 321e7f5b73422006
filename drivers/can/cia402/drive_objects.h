#pragma once
/// Objects of a drive that an axis reads.

#include <vector>

#include "drivers/can/canopen/sdo_codec.h"

namespace luxrig::cia402 {

inline constexpr canopen::ObjectAddress kDeviceType{0x1000, 0}, kDeviceName{0x1008, 0}, kConsumer{0x1016, 1},
    kControlword{0x6040, 0}, kActualPosition{0x6064, 0}, kTargetPosition{0x607A, 0}, kProfileSpeed{0x6081, 0},
    kAcceleration{0x6083, 0}, kDeceleration{0x6084, 0}, kSupportedModes{0x6502, 0};
inline constexpr int kProfilePosition = 1, kHoming = 6;  ///< modes of operation

/// Little-endian value of the first four bytes.
[[nodiscard]] inline std::uint32_t number_in(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

}  // namespace luxrig::cia402
