#pragma once
/// Modbus requests and answers, as PDUs and as Modbus TCP frames (Modbus Application Protocol 1.1b3, Messaging on
/// TCP/IP 1.0b). Pure.
///
/// libmodbus frames and receives (modbus_tcp_link.h), but takes an answer whose length field, unit or echoed address is
/// wrong; every field is checked here.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig::modbus {

inline constexpr std::size_t kLongestAdu = 260;
inline constexpr std::size_t kMostReadRegisters = 125;   ///< functions 3 and 4
inline constexpr std::size_t kMostWriteRegisters = 123;  ///< function 16

enum class Function : std::uint8_t { read_holding = 3, read_input = 4, write_single = 6, write_multiple = 16 };

struct Request {
  int unit = 1;  ///< 0…255
  Function function = Function::read_holding;
  int first_register = 0;             ///< 0…65535, as on the wire
  std::size_t count = 1;              ///< registers to read; ignored when writing
  std::vector<std::uint16_t> values;  ///< registers to write: 1 for write_single
};

[[nodiscard]] constexpr bool reads(Function function) {
  return function == Function::read_holding || function == Function::read_input;
}

/// Function and data. requires counts within the limits above and registers that end at or before 65535.
[[nodiscard]] std::vector<std::uint8_t> encode_pdu(const Request& request);

/// A whole Modbus TCP frame. requires the same.
[[nodiscard]] std::vector<std::uint8_t> encode(const Request& request, std::uint16_t transaction);

enum class Verdict {
  good,       ///< `values` holds what was read (empty after a write)
  exception,  ///< the device understood and said no: `exception_code`
  foreign,    ///< well-formed header of another transaction: `transaction` says which
  garbled     ///< breaks the protocol: `what` says where
};

struct Answer {
  Verdict verdict = Verdict::garbled;
  std::vector<std::uint16_t> values;
  int exception_code = 0;
  std::uint16_t transaction = 0;
  std::string what;
};

/// Function and data of an answer, against the request it should belong to: good, exception or garbled.
[[nodiscard]] Answer decode_pdu(const Request& request, std::span<const std::uint8_t> pdu);

/// One whole Modbus TCP answer as received, against the request it should belong to.
[[nodiscard]] Answer decode(const Request& request, std::uint16_t transaction, std::span<const std::uint8_t> bytes);

/// "illegal data address (2)"
[[nodiscard]] std::string exception_name(int code);

}  // namespace luxrig::modbus
