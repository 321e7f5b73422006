#pragma once
/// DMX values as GDTF writes them. Source: DIN SPEC 15800, "DMXValue".

#include <cstdint>
#include <optional>
#include <string_view>

namespace luxrig {

/// "v/n", a value in n bytes, in the resolution of `bytes` (1…4) bytes: shortened to its most significant ones, or
/// filled up with its own bytes over again (255/1 is 65535 in two, 0x1234/2 is 0x123412 in three). "v/ns" is filled up
/// with zeros. Nothing when the text is no DMXValue, n is not 1…4 or v does not fit into n bytes.
[[nodiscard]] std::optional<std::uint32_t> dmx_value(std::string_view text, int bytes);

}  // namespace luxrig
