#include "drivers/modbus/modbus_rtu_frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"

namespace luxrig::modbus {
namespace {

constexpr std::size_t kChecksumSize = 2;
constexpr std::size_t kRtuExceptionSize = 5;
constexpr std::uint8_t kRtuExceptionFlag = 0x80;

bool checksum_fits(std::span<const std::uint8_t> frame) {
  const std::uint16_t sum = rtu_checksum(frame.first(frame.size() - kChecksumSize));
  return frame[frame.size() - 2] == (sum & 0xFF) && frame[frame.size() - 1] == sum >> 8;
}

}  // namespace

std::uint16_t rtu_checksum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? sum >> 1 ^ 0xA001 : sum >> 1;
  }
  return static_cast<std::uint16_t>(sum);
}

std::vector<std::uint8_t> encode_rtu(const Request& request) {
  LUXRIG_CHECK(request.unit >= 1 && request.unit <= 247, "unit {}", request.unit);
  const std::vector<std::uint8_t> pdu = encode_pdu(request);
  std::vector<std::uint8_t> frame = {static_cast<std::uint8_t>(request.unit)};
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  const std::uint16_t sum = rtu_checksum(frame);
  frame.push_back(static_cast<std::uint8_t>(sum));
  frame.push_back(static_cast<std::uint8_t>(sum >> 8));
  return frame;
}

std::size_t rtu_answer_size(const Request& request) { return reads(request.function) ? 5 + data_bytes(request) : 8; }

RtuSearch find_rtu_answer(const Request& request, std::span<const std::uint8_t> bytes) {
  RtuSearch search;
  const auto unit = static_cast<std::uint8_t>(request.unit);
  const auto function = static_cast<std::uint8_t>(request.function);
  const std::size_t size = rtu_answer_size(request);
  bool begun = false;
  for (std::size_t at = 0; at + 1 < bytes.size(); ++at) {
    if (bytes[at] != unit || (bytes[at + 1] & ~kRtuExceptionFlag) != function) continue;
    const std::size_t wanted = bytes[at + 1] == function ? size : kRtuExceptionSize;
    if (bytes.size() - at < wanted) {
      begun = true;
      continue;
    }
    const auto frame = bytes.subspan(at, wanted);
    if (checksum_fits(frame)) {
      search.answer = decode_pdu(request, frame.subspan(1, wanted - 1 - kChecksumSize));
      return search;
    }
    search.spoiled = true;
  }
  if (bytes.empty()) {
    search.what = "nothing";
  } else if (search.spoiled) {
    search.what = "an answer with a wrong checksum";
  } else if (begun) {
    search.what = "an answer that stopped half-way";
  } else if (bytes.size() >= kRtuExceptionSize && bytes[0] != unit && bytes.size() <= kLongestRtuFrame &&
             checksum_fits(bytes)) {
    search.what = fmt::format("an answer of unit {}", bytes[0]);
  } else if (bytes.size() >= kRtuExceptionSize && bytes[0] == unit && bytes.size() <= kLongestRtuFrame &&
             checksum_fits(bytes)) {
    search.what = fmt::format("an answer with function {} or of another length", bytes[1]);
  } else {
    search.what = fmt::format("{} bytes that are no answer", bytes.size());
  }
  return search;
}

}  // namespace luxrig::modbus
