#include "sim/devices/rdm_frame.h"

namespace luxrig::sim {
namespace {

// Bytes of a packet without parameter data, and offsets of the UIDs.
constexpr std::size_t kMinLength = 24, kTo = 3, kFrom = 9, kUidBytes = 6;

int sum_of(std::span<const std::uint8_t> bytes) {
  int sum = 0;
  for (const std::uint8_t byte : bytes) sum = (sum + byte) & 0xffff;
  return sum;
}

std::uint64_t big_endian_48(std::span<const std::uint8_t> bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < kUidBytes; ++i) number = number << 8 | bytes[i];
  return number;
}

void put(std::vector<std::uint8_t>& bytes, std::uint64_t number, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(number >> (8 * i) & 0xff));
}

}  // namespace

std::optional<RdmFrame> read_rdm(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kMinLength + 2 || bytes[0] != 0xcc || bytes[1] != 0x01) return std::nullopt;
  const std::size_t length = bytes[2];
  if (length < kMinLength || bytes.size() < length + 2 || length - kMinLength != bytes[23]) return std::nullopt;
  if (sum_of(bytes.first(length)) != (bytes[length] << 8 | bytes[length + 1])) return std::nullopt;
  RdmFrame frame;
  frame.to = big_endian_48(bytes.subspan(kTo));
  frame.from = big_endian_48(bytes.subspan(kFrom));
  frame.transaction = bytes[15];
  frame.port_or_type = bytes[16];
  frame.messages = bytes[17];
  frame.sub_device = bytes[18] << 8 | bytes[19];
  frame.command_class = bytes[20];
  frame.pid = bytes[21] << 8 | bytes[22];
  const auto data = bytes.subspan(kMinLength, bytes[23]);
  frame.data.assign(data.begin(), data.end());
  return frame;
}

std::vector<std::uint8_t> write_rdm(const RdmFrame& frame) {
  std::vector<std::uint8_t> bytes = {0xcc, 0x01, static_cast<std::uint8_t>(kMinLength + frame.data.size())};
  put(bytes, frame.to, 6);
  put(bytes, frame.from, 6);
  bytes.insert(bytes.end(), {frame.transaction, frame.port_or_type, frame.messages});
  put(bytes, static_cast<std::uint64_t>(frame.sub_device), 2);
  bytes.push_back(static_cast<std::uint8_t>(frame.command_class));
  put(bytes, static_cast<std::uint64_t>(frame.pid), 2);
  bytes.push_back(static_cast<std::uint8_t>(frame.data.size()));
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.end());
  put(bytes, static_cast<std::uint64_t>(sum_of(bytes)), 2);
  return bytes;
}

std::vector<std::uint8_t> write_branch_answer(std::uint64_t uid) {
  std::vector<std::uint8_t> plain, encoded;
  put(plain, uid, 6);
  const auto encode = [&encoded](std::uint8_t byte) {
    encoded.push_back(byte | 0xaa);
    encoded.push_back(byte | 0x55);
  };
  for (const std::uint8_t byte : plain) encode(byte);
  const int checksum = sum_of(encoded);
  encode(static_cast<std::uint8_t>(checksum >> 8));
  encode(static_cast<std::uint8_t>(checksum & 0xff));
  std::vector<std::uint8_t> answer(7, 0xfe);
  answer.push_back(0xaa);
  answer.insert(answer.end(), encoded.begin(), encoded.end());
  return answer;
}

}  // namespace luxrig::sim
