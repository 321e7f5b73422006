#include "sim/wire/modbus/modbus_rtu_session.h"

#include <algorithm>
#include <array>

namespace luxrig::sim {
namespace {

using LineBytes = std::span<const std::uint8_t>;

constexpr std::size_t kShortestFrame = 4, kLongestFrame = 256;

// CRC by table, as in appendix B of the standard.
constexpr std::array<std::uint16_t, 256> kLineTable = [] {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned value = i;
    for (int k = 0; k < 8; ++k) value = value & 1u ? 0xA001u ^ (value >> 1) : value >> 1;
    table[i] = static_cast<std::uint16_t>(value);
  }
  return table;
}();

/// Length of the request at the start; 0 = not known yet; -1 = unknown until it ends.
int request_length(LineBytes bytes) {
  if (bytes.size() < 2) return 0;
  const int function = bytes[1];
  if (function >= 1 && function <= 6) return 8;
  if (function != 15 && function != 16) return -1;
  return bytes.size() < 7 ? 0 : 9 + bytes[6];
}

void append_checksum(std::vector<std::uint8_t>& frame) {
  const std::uint16_t sum = line_checksum(frame);
  frame.push_back(static_cast<std::uint8_t>(sum & 0xff));
  frame.push_back(static_cast<std::uint8_t>(sum >> 8));
}

FaultKind some_damage(std::uint64_t random) {
  constexpr FaultKind kDamages[] = {FaultKind::checksum, FaultKind::truncated,  FaultKind::noise,
                                    FaultKind::gap,      FaultKind::wrong_unit, FaultKind::wrong_function};
  return kDamages[random % std::size(kDamages)];
}

/// The answer as the line carries it, with its fault.
std::vector<LinePiece> on_line(std::vector<std::uint8_t> frame, Time due, const Disturbance& disturbance) {
  std::optional<FaultKind> damage = disturbance.on_line;
  double value = disturbance.on_line_value;
  const std::uint64_t random = disturbance.random >> 8;
  if (disturbance.garbled) {
    damage = some_damage(disturbance.random);
    value = *damage == FaultKind::gap ? 300 : static_cast<double>(1 + random % 4);
  }
  if (damage == FaultKind::wrong_unit) frame[0] = static_cast<std::uint8_t>(frame[0] % 247 + 1);
  if (damage == FaultKind::wrong_function) frame[1] = static_cast<std::uint8_t>(frame[1] ^ 0x07);
  append_checksum(frame);
  const auto share = static_cast<std::size_t>(value);
  switch (damage.value_or(FaultKind::lost)) {
    case FaultKind::checksum:
      frame.back() ^= static_cast<std::uint8_t>(1 + random % 255);
      break;
    case FaultKind::truncated:
      frame.resize(frame.size() - std::min(share, frame.size() - 1));
      break;
    case FaultKind::noise: {
      std::vector<std::uint8_t> noise;
      for (std::size_t i = 0; i < share; ++i) noise.push_back(static_cast<std::uint8_t>(random >> (i % 7 * 8)));
      frame.insert(frame.begin(), noise.begin(), noise.end());
      break;
    }
    case FaultKind::gap: {
      const auto half = frame.begin() + static_cast<std::ptrdiff_t>(frame.size() / 2);
      return {{due, {frame.begin(), half}}, {due + from_seconds(value * 1e-3), {half, frame.end()}}};
    }
    default:
      break;
  }
  return {{due, std::move(frame)}};
}

}  // namespace

std::uint16_t line_checksum(LineBytes bytes) {
  std::uint16_t sum = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    sum = static_cast<std::uint16_t>(sum >> 8 ^ kLineTable[(sum ^ byte) & 0xff]);
  }
  return sum;
}

std::vector<LinePiece> ModbusRtuSession::receive(Time now, LineBytes bytes, ModbusUnits& units) {
  std::vector<LinePiece> pieces;
  if (!pending_.empty() && now - last_byte_ > kLongestPause) pending_.clear();
  if (bytes.empty()) return pieces;
  last_byte_ = now;
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  while (!pending_.empty()) {
    const int length = request_length(pending_);
    if (length == 0) break;
    const std::size_t size = length < 0 ? pending_.size() : static_cast<std::size_t>(length);
    if (size > kLongestFrame || pending_.size() > 4 * kLongestFrame) {
      pending_.clear();
      break;
    }
    if (pending_.size() < size) break;
    if (size < kShortestFrame) {
      if (length > 0) pending_.clear();
      break;
    }
    const LineBytes frame = LineBytes(pending_).first(size);
    if (line_checksum(frame) != 0) {  // the start of the next frame is unknown: wait for silence
      if (length > 0) pending_.clear();
      break;
    }
    const int unit = frame[0];
    const LineBytes request = frame.subspan(1, size - 3);
    if (unit != 0 && units.has(unit)) {
      const Disturbance disturbance = units.disturbance(unit);
      if (!disturbance.silent) {
        std::vector<std::uint8_t> answer = {frame[0]};
        const std::vector<std::uint8_t> pdu =
            disturbance.exception ? std::vector<std::uint8_t>{static_cast<std::uint8_t>(request[0] | 0x80),
                                                              static_cast<std::uint8_t>(*disturbance.exception)}
                                  : answer_pdu(unit, request, units);
        answer.insert(answer.end(), pdu.begin(), pdu.end());
        const auto said = on_line(std::move(answer), now + disturbance.delay, disturbance);
        for (int i = 0; i < (disturbance.duplicated ? 2 : 1); ++i)
          pieces.insert(pieces.end(), said.begin(), said.end());
      }
    }
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(size));
  }
  if (pending_.size() > kLongestFrame) pending_.clear();
  return pieces;
}

}  // namespace luxrig::sim
