#pragma once
/// The values of Open Fixture Library files. Private to core/rig/personality.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace luxrig {

using OflJson = nlohmann::ordered_json;  // pixel groups are numbered in file order

/// A member, or a null value if it is absent. Never throws, whatever `object` is.
[[nodiscard]] const OflJson& ofl_member(const OflJson& object, const char* key);

/// Its text, made plain; empty if it is not a text.
[[nodiscard]] std::string ofl_text(const OflJson& value);
[[nodiscard]] std::vector<std::string> ofl_texts(const OflJson& value);

/// "540deg" with unit "deg"; a bare number has no unit.
[[nodiscard]] std::optional<double> ofl_entity(const OflJson& value, std::string_view unit);

/// A brightness: "50%" is 0.5; off 0, dark 0.01, bright 1.
[[nodiscard]] std::optional<double> ofl_brightness(const OflJson& value);

/// A DMX value, given as a number in `bytes` bytes or as a share of their range ("50%"), converted to `bytes_wanted`
/// bytes. OFL extends with zeros. nullopt if it is neither, or does not fit.
[[nodiscard]] std::optional<std::uint32_t> ofl_dmx(const OflJson& value, int bytes, int bytes_wanted);

/// Replaces "$pixelKey" in a template.
[[nodiscard]] std::string with_pixel(std::string text, std::string_view pixel);

}  // namespace luxrig
