#pragma once
/// A classic CAN frame (ISO 11898-1) and its 16 bytes as Linux lays them out (struct can_frame of linux/can.h):
/// identifier with flags 32 bit, length 8 bit, three unused, eight of data. In a datagram the identifier is
/// little-endian. Pure.

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

namespace luxrig::can {

inline constexpr std::size_t kFrameBytes = 16;
inline constexpr std::uint32_t kExtendedFlag = 0x80000000, kRemoteFlag = 0x40000000, kErrorFlag = 0x20000000;

struct CanFrame {
  std::uint32_t id = 0;  ///< 11 bit, 29 when extended; of an error frame: its classes (bus_state.h)
  bool extended = false, remote = false, error = false;
  std::uint8_t size = 0;                               ///< 0…8
  std::array<std::uint8_t, 8> data{};                  ///< 0 from `size` on
  std::optional<std::chrono::nanoseconds> received{};  ///< by the kernel's wall clock, where it stamps

  [[nodiscard]] std::span<const std::uint8_t> payload() const { return {data.data(), size}; }
};

/// requires an 11-bit id and at most 8 bytes.
[[nodiscard]] CanFrame data_frame(std::uint32_t id, std::span<const std::uint8_t> payload);

[[nodiscard]] std::array<std::uint8_t, kFrameBytes> to_bytes(const CanFrame& frame);
/// Empty unless there are exactly 16 bytes and the length is at most 8.
[[nodiscard]] std::optional<CanFrame> from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::can
