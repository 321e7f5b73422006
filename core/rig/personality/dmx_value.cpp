#include "core/rig/personality/dmx_value.h"

#include <charconv>

namespace luxrig {

std::optional<std::uint32_t> dmx_value(std::string_view text, int bytes) {
  const char* const end = text.data() + text.size();
  std::uint64_t value = 0;
  const auto [slash, value_error] = std::from_chars(text.data(), end, value);
  if (value_error != std::errc{} || slash == end || *slash != '/') return std::nullopt;
  int given = 0;
  const auto [rest, given_error] = std::from_chars(slash + 1, end, given);
  if (given_error != std::errc{} || given < 1 || given > 4) return std::nullopt;
  const bool shifted = rest != end && *rest == 's';
  if (rest + (shifted ? 1 : 0) != end || value >= std::uint64_t{1} << (8 * given)) return std::nullopt;
  if (given >= bytes) return static_cast<std::uint32_t>(value >> (8 * (given - bytes)));
  std::uint32_t out = 0;
  for (int i = 0; i < bytes; ++i) {
    const auto byte = static_cast<std::uint32_t>(value >> (8 * (given - 1 - i % given))) & 0xFF;
    out = out << 8 | (shifted && i >= given ? 0 : byte);
  }
  return out;
}

}  // namespace luxrig
