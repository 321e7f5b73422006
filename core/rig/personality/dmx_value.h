#pragma once
/// DMX values as written in GDTF. Source: DIN SPEC 15800, "DMXValue".

#include <cstdint>
#include <optional>
#include <string_view>

namespace luxrig {

/// "v/n", a value in n bytes, converted to `bytes` (1…4) bytes. It is cut to its most significant bytes, or extended by
/// repeating its own bytes (255/1 is 65535 in two, 0x1234/2 is 0x123412 in three). "v/ns" is extended with zeros.
/// nullopt if the text is not a DMXValue, n is not 1…4 or v does not fit into n bytes.
[[nodiscard]] std::optional<std::uint32_t> dmx_value(std::string_view text, int bytes);

}  // namespace luxrig
