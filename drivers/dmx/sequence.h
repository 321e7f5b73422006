#pragma once
/// The sequence rule that sACN (ANSI E1.31-2018, clause 6.7.2) and Art-Net share.

#include <cstdint>

namespace luxrig {

/// Packets this far or less behind the last one are dropped; one further behind comes from a restarted sender.
inline constexpr int kSequenceWindow = 20;

/// True if a packet must be dropped: its number is 0…19 behind the last accepted one.
[[nodiscard]] constexpr bool is_out_of_order(std::uint8_t sequence, std::uint8_t last) {
  const auto ahead = static_cast<std::int8_t>(static_cast<std::uint8_t>(sequence - last));
  return ahead <= 0 && ahead > -kSequenceWindow;
}

/// A restarted sender does not know the number that receivers remember, some of them for ever. One jump by the window
/// after its first packet gets past any such number: if the first is 0…19 behind, the second is ahead.
inline constexpr int kJumpAfterFirstPacket = kSequenceWindow;

}  // namespace luxrig
