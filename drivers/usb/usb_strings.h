#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace luxrig {

/// Text of a string descriptor (USB 2.0 section 9.6.7: length, 3, UTF-16LE) as UTF-8. A truncated or garbled one gives
/// its readable part; control characters and lone surrogates become '?'.
[[nodiscard]] std::string text_of_string_descriptor(std::span<const std::uint8_t> bytes);

}  // namespace luxrig
