#include "drivers/modbus/modbus_codec.h"

#include <fmt/format.h>

#include "core/check.h"

namespace luxrig::modbus {
namespace {

// Offsets in a PDU: Application Protocol 1.1b3, 6.3–6.12.
constexpr std::size_t kFunction = 0;
constexpr std::size_t kExceptionCode = 1;
constexpr std::size_t kByteCount = 1;  // answer to a read
constexpr std::size_t kReadData = 2;
constexpr std::size_t kAddress = 1;  // request, and the echo of a write
constexpr std::size_t kValue = 3;    // write_single; elsewhere the number of registers
constexpr std::size_t kWriteByteCount = 5;
constexpr std::size_t kWriteData = 6;
constexpr std::size_t kWriteAnswerSize = 5;
constexpr std::size_t kExceptionSize = 2;
constexpr std::uint8_t kExceptionFlag = 0x80;

// Offsets in a TCP frame. MBAP header: Messaging on TCP/IP 1.0b, 3.1.3.
constexpr std::size_t kTransaction = 0;
constexpr std::size_t kProtocol = 2;
constexpr std::size_t kLength = 4;  // of what follows: unit and PDU
constexpr std::size_t kUnit = 6;
constexpr std::size_t kPdu = 7;

void put16(std::vector<std::uint8_t>& out, std::size_t at, std::size_t value) {
  out[at] = static_cast<std::uint8_t>(value >> 8);
  out[at + 1] = static_cast<std::uint8_t>(value);
}
std::uint16_t get16(std::span<const std::uint8_t> in, std::size_t at) {
  return static_cast<std::uint16_t>(in[at] << 8 | in[at + 1]);
}

}  // namespace

std::vector<std::uint8_t> encode_pdu(const Request& request) {
  const std::size_t count = reads(request.function) ? request.count : request.values.size();
  const std::size_t most = reads(request.function)                      ? kMostReadRegisters
                           : request.function == Function::write_single ? 1
                                                                        : kMostWriteRegisters;
  LUXRIG_CHECK(count >= 1 && count <= most, "{} registers with function {}", count, static_cast<int>(request.function));
  LUXRIG_CHECK(request.first_register >= 0 && static_cast<std::size_t>(request.first_register) + count <= 65536,
               "registers {} + {}", request.first_register, count);
  LUXRIG_CHECK(request.unit >= 0 && request.unit <= 255, "unit {}", request.unit);

  const bool multiple = request.function == Function::write_multiple;
  std::vector<std::uint8_t> out(multiple ? kWriteData + 2 * count : kWriteAnswerSize, 0);
  out[kFunction] = static_cast<std::uint8_t>(request.function);
  put16(out, kAddress, static_cast<std::size_t>(request.first_register));
  put16(out, kValue, request.function == Function::write_single ? request.values[0] : count);
  if (multiple) {
    out[kWriteByteCount] = static_cast<std::uint8_t>(2 * count);
    for (std::size_t i = 0; i < count; ++i) put16(out, kWriteData + 2 * i, request.values[i]);
  }
  return out;
}

std::vector<std::uint8_t> encode(const Request& request, std::uint16_t transaction) {
  const std::vector<std::uint8_t> pdu = encode_pdu(request);
  std::vector<std::uint8_t> out(kPdu, 0);
  put16(out, kTransaction, transaction);
  put16(out, kProtocol, 0);
  put16(out, kLength, pdu.size() + 1);
  out[kUnit] = static_cast<std::uint8_t>(request.unit);
  out.insert(out.end(), pdu.begin(), pdu.end());
  return out;
}

Answer decode_pdu(const Request& request, std::span<const std::uint8_t> pdu) {
  Answer answer;
  const auto garbled = [&](std::string what) {
    answer.verdict = Verdict::garbled;
    answer.what = std::move(what);
    return answer;
  };
  if (pdu.size() < kExceptionSize) return garbled(fmt::format("{} bytes", pdu.size()));
  const auto function = static_cast<std::uint8_t>(request.function);
  if (pdu[kFunction] == (function | kExceptionFlag)) {
    if (pdu.size() != kExceptionSize) return garbled(fmt::format("exception of {} bytes", pdu.size()));
    answer.verdict = Verdict::exception;
    answer.exception_code = pdu[kExceptionCode];
    return answer;
  }
  if (pdu[kFunction] != function) return garbled(fmt::format("answer with function {}", pdu[kFunction]));

  if (reads(request.function)) {
    if (pdu[kByteCount] != 2 * request.count || pdu.size() != kReadData + 2 * request.count) {
      return garbled(fmt::format("{} data bytes announced, {} there, {} wanted", pdu[kByteCount],
                                 pdu.size() - kReadData, 2 * request.count));
    }
    for (std::size_t i = 0; i < request.count; ++i) answer.values.push_back(get16(pdu, kReadData + 2 * i));
  } else {
    const std::size_t echo =
        request.function == Function::write_single ? std::size_t{request.values[0]} : request.values.size();
    if (pdu.size() != kWriteAnswerSize || get16(pdu, kAddress) != request.first_register ||
        get16(pdu, kValue) != echo) {
      return garbled("the echo of a write differs from what was written");
    }
  }
  answer.verdict = Verdict::good;
  return answer;
}

Answer decode(const Request& request, std::uint16_t transaction, std::span<const std::uint8_t> bytes) {
  Answer answer;
  const auto garbled = [&](std::string what) {
    answer.verdict = Verdict::garbled;
    answer.what = std::move(what);
    return answer;
  };
  if (bytes.size() < kPdu + kExceptionSize || bytes.size() > kLongestAdu)
    return garbled(fmt::format("{} bytes", bytes.size()));
  if (get16(bytes, kProtocol) != 0) return garbled(fmt::format("protocol {} in place of 0", get16(bytes, kProtocol)));
  if (get16(bytes, kLength) != bytes.size() - kUnit) {
    return garbled(fmt::format("length field {} with {} bytes behind it", get16(bytes, kLength), bytes.size() - kUnit));
  }
  answer.transaction = get16(bytes, kTransaction);
  if (answer.transaction != transaction) {
    answer.verdict = Verdict::foreign;
    answer.what = fmt::format("answer to transaction {} in place of {}", answer.transaction, transaction);
    return answer;
  }
  if (bytes[kUnit] != request.unit) return garbled(fmt::format("answer of unit {}", bytes[kUnit]));
  answer = decode_pdu(request, bytes.subspan(kPdu));
  answer.transaction = transaction;
  return answer;
}

std::string exception_name(int code) {
  const char* name = "unknown exception";
  switch (code) {
    case 1:
      name = "illegal function";
      break;
    case 2:
      name = "illegal data address";
      break;
    case 3:
      name = "illegal data value";
      break;
    case 4:
      name = "device failure";
      break;
    case 5:
      name = "acknowledge, still working";
      break;
    case 6:
      name = "device busy";
      break;
    case 8:
      name = "memory parity error";
      break;
    case 10:
      name = "gateway path unavailable";
      break;
    case 11:
      name = "gateway target does not respond";
      break;
    default:
      break;
  }
  return fmt::format("{} ({})", name, code);
}

}  // namespace luxrig::modbus
