#pragma once
/// A CAN frame on the simulated bus, and its 16 bytes in a datagram: identifier (32 bit, little-endian; bit 29 marks an
/// error frame as Linux reports it), length, three unused, eight of data.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace luxrig::sim {

struct BusFrame {
  std::uint32_t id = 0;  ///< 11 bit; with kErrorFrame: error classes
  std::uint8_t size = 0;
  std::array<std::uint8_t, 8> data{};
  bool operator==(const BusFrame&) const = default;
};

inline constexpr std::uint32_t kErrorFrame = 0x20000000, kBusOffError = 0x40, kRestartedError = 0x100;

[[nodiscard]] inline BusFrame bus_frame(std::uint32_t id, std::span<const std::uint8_t> payload) {
  BusFrame frame{id, static_cast<std::uint8_t>(payload.size() < 8 ? payload.size() : 8), {}};
  for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = payload[i];
  return frame;
}

[[nodiscard]] inline std::array<std::uint8_t, 16> packed(const BusFrame& frame) {
  std::array<std::uint8_t, 16> bytes{};
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(frame.id >> (8 * i));
  bytes[4] = frame.size;
  for (std::size_t i = 0; i < 8; ++i) bytes[8 + i] = frame.data[i];
  return bytes;
}

/// Empty unless it is a data frame with an 11-bit identifier.
[[nodiscard]] inline std::optional<BusFrame> unpacked(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != 16 || bytes[4] > 8) return std::nullopt;
  BusFrame frame;
  for (std::size_t i = 0; i < 4; ++i) frame.id |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  if (frame.id > 0x7FF) return std::nullopt;
  frame.size = bytes[4];
  for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = bytes[8 + i];
  return frame;
}

}  // namespace luxrig::sim
