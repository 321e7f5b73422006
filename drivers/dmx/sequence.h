#pragma once
/// The sequence rule that sACN (ANSI E1.31-2018, clause 6.7.2) and Art-Net share.

#include <cstdint>

namespace luxrig {

/// Packets this far behind the last one, and less, are dropped; what is further behind is a sender that began anew.
inline constexpr int kSequenceWindow = 20;

/// True when a packet is to be dropped: its number is 0…19 behind the last one that was taken.
[[nodiscard]] constexpr bool is_out_of_order(std::uint8_t sequence, std::uint8_t last) {
  const auto ahead = static_cast<std::int8_t>(static_cast<std::uint8_t>(sequence - last));
  return ahead <= 0 && ahead > -kSequenceWindow;
}

/// A sender that was restarted does not know the number that receivers remember, some of them for ever. One jump by the
/// window after its first packet gets past it, whatever it was: if the first is 0…19 behind, the second is ahead.
inline constexpr int kJumpAfterFirstPacket = kSequenceWindow;

}  // namespace luxrig
