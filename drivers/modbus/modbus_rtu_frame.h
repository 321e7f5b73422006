#pragma once
/// Modbus RTU frames (MODBUS over Serial Line 1.02, 2.5.1): unit, PDU, checksum. Pure.

#include <optional>
#include <span>

#include "drivers/modbus/modbus_codec.h"

namespace luxrig::modbus {

inline constexpr std::size_t kLongestRtuFrame = 256;

/// CRC-16 of the serial line: polynomial 0xA001, initial value 0xFFFF. Its low byte is sent first.
[[nodiscard]] std::uint16_t rtu_checksum(std::span<const std::uint8_t> bytes);

/// requires the same as encode_pdu(), and a unit in 1…247.
[[nodiscard]] std::vector<std::uint8_t> encode_rtu(const Request& request);

/// Bytes of the answer, unless it is an exception.
[[nodiscard]] std::size_t rtu_answer_size(const Request& request);

struct RtuSearch {
  std::optional<Answer> answer;  ///< good, exception or garbled (right checksum, wrong content)
  bool spoiled = false;          ///< a complete answer of the unit is there, but its checksum is wrong
  std::string what;              ///< without an answer: description of the bytes, for a person
};

/// Finds the answer to `request` in the bytes received since it was sent. A frame may start anywhere if its checksum is
/// right, so line noise, stale halves and frames of other units before it are skipped.
/// Cost: bytes × length of the answer, only where unit and function fit.
[[nodiscard]] RtuSearch find_rtu_answer(const Request& request, std::span<const std::uint8_t> bytes);

}  // namespace luxrig::modbus
