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
constexpr std::size_t kLength = 4;  // of unit and PDU, which follow
constexpr std::size_t kUnit = 6;
constexpr std::size_t kPdu = 7;

void put16(std::vector<std::uint8_t>& out, std::size_t at, std::size_t value) {
  out[at] = static_cast<std::uint8_t>(value >> 8);
  out[at + 1] = static_cast<std::uint8_t>(value);
}
std::uint16_t get16(std::span<const std::uint8_t> in, std::size_t at) {
  return static_cast<std::uint16_t>(in[at] << 8 | in[at + 1]);
}

constexpr std::uint16_t kCoilOn = 0xff00;  // 6.5

std::size_t max_of(Function function) {
  switch (function) {
    case Function::read_coils:
    case Function::read_discrete:
      return kMaxReadBits;
    case Function::read_holding:
    case Function::read_input:
      return kMaxReadRegisters;
    case Function::write_coil:
    case Function::write_single:
      return 1;
    case Function::write_coils:
      return kMaxWriteCoils;
    case Function::write_multiple:
      return kMaxWriteRegisters;
  }
  return 0;
}

/// Value of a request's count field; a write's answer repeats it.
std::size_t value_field(const Request& request) {
  if (reads(request.function)) return request.count;
  if (request.function == Function::write_coil) return request.values[0] != 0 ? kCoilOn : 0;
  return request.function == Function::write_single ? std::size_t{request.values[0]} : request.values.size();
}

}  // namespace

std::vector<std::uint8_t> encode_pdu(const Request& request) {
  const std::size_t count = reads(request.function) ? request.count : request.values.size();
  LUXRIG_CHECK(count >= 1 && count <= max_of(request.function), "{} registers with function {}", count,
               static_cast<int>(request.function));
  LUXRIG_CHECK(request.first_register >= 0 && static_cast<std::size_t>(request.first_register) + count <= 65536,
               "registers {} + {}", request.first_register, count);
  LUXRIG_CHECK(request.unit >= 0 && request.unit <= 255, "unit {}", request.unit);

  const bool coils = request.function == Function::write_coils;
  const bool multiple = request.function == Function::write_multiple || coils;
  const std::size_t bytes = coils ? (count + 7) / 8 : 2 * count;
  std::vector<std::uint8_t> out(multiple ? kWriteData + bytes : kWriteAnswerSize, 0);
  out[kFunction] = static_cast<std::uint8_t>(request.function);
  put16(out, kAddress, static_cast<std::size_t>(request.first_register));
  put16(out, kValue, value_field(request));
  if (multiple) {
    out[kWriteByteCount] = static_cast<std::uint8_t>(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (!coils)
        put16(out, kWriteData + 2 * i, request.values[i]);
      else if (request.values[i] != 0)
        out[kWriteData + i / 8] = static_cast<std::uint8_t>(out[kWriteData + i / 8] | 1u << i % 8);
    }
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
    const std::size_t bytes = data_bytes(request);
    if (pdu[kByteCount] != bytes || pdu.size() != kReadData + bytes) {
      return garbled(
          fmt::format("{} data bytes announced, {} there, {} wanted", pdu[kByteCount], pdu.size() - kReadData, bytes));
    }
    for (std::size_t i = 0; i < request.count; ++i) {
      // Bits beyond the last one requested are padding, and some products leave other data there.
      answer.values.push_back(is_of_bits(request.function)
                                  ? static_cast<std::uint16_t>(pdu[kReadData + i / 8] >> i % 8 & 1)
                                  : get16(pdu, kReadData + 2 * i));
    }
  } else {
    if (pdu.size() != kWriteAnswerSize || get16(pdu, kAddress) != request.first_register ||
        get16(pdu, kValue) != value_field(request)) {
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
