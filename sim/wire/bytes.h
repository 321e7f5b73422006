#pragma once
/// Numbers in packets. requires enough bytes.

#include <cstdint>
#include <span>
#include <vector>

namespace luxrig::sim {

[[nodiscard]] inline int big_endian_16(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return bytes[offset] << 8 | bytes[offset + 1];
}
[[nodiscard]] inline int little_endian_16(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return bytes[offset] | bytes[offset + 1] << 8;
}
[[nodiscard]] inline std::uint32_t big_endian_32(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(big_endian_16(bytes, offset)) << 16 |
         static_cast<std::uint32_t>(big_endian_16(bytes, offset + 2));
}
inline void append_big_endian_16(std::vector<std::uint8_t>& bytes, int value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8 & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
}

}  // namespace luxrig::sim
