#pragma once
/// Modbus requests and answers, as PDUs and as Modbus TCP frames (Modbus Application Protocol 1.1b3, Messaging on
/// TCP/IP 1.0b). Pure.
///
/// libmodbus frames and receives (modbus_tcp_link.h), but accepts an answer with a wrong length field, unit or echoed
/// address. So every field is checked here.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig::modbus {

inline constexpr std::size_t kLongestAdu = 260;
inline constexpr std::size_t kMaxReadRegisters = 125;   ///< functions 3 and 4
inline constexpr std::size_t kMaxWriteRegisters = 123;  ///< function 16
inline constexpr std::size_t kMaxReadBits = 2000;       ///< functions 1 and 2
inline constexpr std::size_t kMaxWriteCoils = 1968;     ///< function 15

enum class Function : std::uint8_t {
  read_coils = 1,
  read_discrete = 2,
  read_holding = 3,
  read_input = 4,
  write_coil = 5,
  write_single = 6,
  write_coils = 15,
  write_multiple = 16
};

struct Request {
  int unit = 1;  ///< 0…255
  Function function = Function::read_holding;
  int first_register = 0;             ///< 0…65535, as on the wire
  std::size_t count = 1;              ///< registers or bits to read; ignored when writing
  std::vector<std::uint16_t> values;  ///< registers to write, or bits (0 or 1): 1 for write_single and write_coil
};

[[nodiscard]] constexpr bool reads(Function function) { return function <= Function::read_input; }
[[nodiscard]] constexpr bool is_of_bits(Function function) {
  return function == Function::read_coils || function == Function::read_discrete || function == Function::write_coil ||
         function == Function::write_coils;
}
/// In the answer to a read.
[[nodiscard]] constexpr std::size_t data_bytes(const Request& request) {
  return is_of_bits(request.function) ? (request.count + 7) / 8 : 2 * request.count;
}

/// Function and data. requires counts within the limits above and no register beyond 65535.
[[nodiscard]] std::vector<std::uint8_t> encode_pdu(const Request& request);

/// A whole Modbus TCP frame. requires the same.
[[nodiscard]] std::vector<std::uint8_t> encode(const Request& request, std::uint16_t transaction);

enum class Verdict {
  good,       ///< `values` holds the data read, bits as 0 and 1 (empty after a write)
  exception,  ///< the device understood and refused: `exception_code`
  foreign,    ///< valid header of another transaction: `transaction`
  garbled     ///< breaks the protocol: `what` says where
};

struct Answer {
  Verdict verdict = Verdict::garbled;
  std::vector<std::uint16_t> values;
  int exception_code = 0;
  std::uint16_t transaction = 0;
  std::string what;
};

/// Function and data of an answer, checked against its request: good, exception or garbled.
[[nodiscard]] Answer decode_pdu(const Request& request, std::span<const std::uint8_t> pdu);

/// One whole Modbus TCP answer as received, checked against its request.
[[nodiscard]] Answer decode(const Request& request, std::uint16_t transaction, std::span<const std::uint8_t> bytes);

/// "illegal data address (2)"
[[nodiscard]] std::string exception_name(int code);

}  // namespace luxrig::modbus
