#pragma once
/// All units on one RS-485 line, as a master sees them. Pure: bytes in, answers out, each with its due time.
/// Source: MODBUS over Serial Line V1.02 and Application Protocol V1.1b3.

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"
#include "sim/wire/modbus/modbus_session.h"

namespace luxrig::sim {

/// Bytes that a unit sends in one go.
struct LinePiece {
  Time due{};
  std::vector<std::uint8_t> bytes;
};

class ModbusRtuSession {
 public:
  /// Takes received bytes. Does not answer a frame that is broken, a broadcast, or for an unknown unit. Discards a
  /// partial frame after a pause longer than kLongestPause, as a unit does after 3.5 silent characters.
  std::vector<LinePiece> receive(Time now, std::span<const std::uint8_t> bytes, ModbusUnits& units);
  void forget() { pending_.clear(); }

  /// Far above the standard's 3.5 characters: a pseudo terminal may delay bytes on a busy machine.
  static constexpr Duration kLongestPause = std::chrono::milliseconds(40);

 private:
  std::vector<std::uint8_t> pending_;  ///< start of a request; at most 256 bytes between calls
  Time last_byte_{};
};

/// CRC of the serial line over `bytes`: appended low byte first it makes the checksum of the whole 0.
[[nodiscard]] std::uint16_t line_checksum(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::sim
