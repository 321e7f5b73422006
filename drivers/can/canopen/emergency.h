#pragma once
/// Emergency messages (CiA 301, 7.2.7) and the error codes that they share with object 603F (CiA 402-2). Pure.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/can/can_frame.h"

namespace luxrig::canopen {

struct Emergency {
  std::uint16_t code = 0;           ///< 0 = errors are gone
  std::uint8_t error_register = 0;  ///< object 1001
  std::array<std::uint8_t, 5> of_maker{};
};

/// Empty unless it has 8 bytes.
[[nodiscard]] std::optional<Emergency> decode_emergency(const can::CanFrame& frame);

/// "following error (8611)"; a code without its own name gets the name of its class.
[[nodiscard]] std::string error_text(std::uint16_t code);

}  // namespace luxrig::canopen
