#include "drivers/can/can_frame.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig::can {
namespace {

constexpr std::uint32_t kStandardId = 0x7FF, kExtendedId = 0x1FFFFFFF;

}  // namespace

CanFrame data_frame(std::uint32_t id, std::span<const std::uint8_t> payload) {
  LUXRIG_CHECK(id <= kStandardId && payload.size() <= 8, "frame {:x} of {} bytes", id, payload.size());
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(payload.size());
  std::copy(payload.begin(), payload.end(), frame.data.begin());
  return frame;
}

std::array<std::uint8_t, kFrameBytes> to_bytes(const CanFrame& frame) {
  const std::uint32_t word = frame.id | (frame.extended ? kExtendedFlag : 0) | (frame.remote ? kRemoteFlag : 0) |
                             (frame.error ? kErrorFlag : 0);
  std::array<std::uint8_t, kFrameBytes> bytes{};
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(word >> (8 * i));
  bytes[4] = frame.size;
  std::copy(frame.data.begin(), frame.data.end(), bytes.begin() + 8);
  return bytes;
}

std::optional<CanFrame> from_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kFrameBytes || bytes[4] > 8) return std::nullopt;
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  CanFrame frame;
  frame.error = (word & kErrorFlag) != 0;
  frame.remote = (word & kRemoteFlag) != 0;
  frame.extended = (word & kExtendedFlag) != 0;
  frame.id = word & (frame.extended || frame.error ? kExtendedId : kStandardId);
  frame.size = bytes[4];
  std::copy_n(bytes.begin() + 8, frame.size, frame.data.begin());
  return frame;
}

}  // namespace luxrig::can
