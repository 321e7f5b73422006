#include "sim/wire/modbus/modbus_session.h"

#include <algorithm>

#include "sim/wire/bytes.h"

namespace luxrig::sim {
namespace {

using Bytes = std::span<const std::uint8_t>;

// MBAP header: transaction 2, protocol 2 (0), length 2 (unit and PDU), unit 1.
constexpr std::size_t kHeader = 7;
constexpr int kMinLength = 2, kMaxLength = 254;  // unit + PDU of 1…253 bytes
constexpr int kMaxRead = 125, kMaxWrite = 123;
constexpr int kMaxReadBits = 2000, kMaxWriteBits = 1968;
constexpr int kCoilOn = 0xff00;

std::vector<std::uint8_t> refusal(std::uint8_t function, int code) {
  return {static_cast<std::uint8_t>(function | 0x80), static_cast<std::uint8_t>(code)};
}

std::vector<std::uint8_t> refusal(std::uint8_t function, ModbusException code) {
  return refusal(function, static_cast<int>(code));
}

// 6.3, 6.4: function, first, count -> function, byte count, values.
std::vector<std::uint8_t> read_registers(int unit, Bytes request, ModbusUnits& units) {
  const std::uint8_t function = request[0];
  if (request.size() != 5) return refusal(function, ModbusException::illegal_value);
  const int first = big_endian_16(request, 1), count = big_endian_16(request, 3);
  if (count < 1 || count > kMaxRead) return refusal(function, ModbusException::illegal_value);
  if (first + count > 65536) return refusal(function, ModbusException::illegal_address);
  if (const auto refused = units.refuses(unit, function, count)) return refusal(function, *refused);
  std::vector<std::uint16_t> values(static_cast<std::size_t>(count), 0);
  const RegisterKind kind = function == 3 ? RegisterKind::holding : RegisterKind::input;
  if (const auto refused = units.read(unit, kind, first, values)) return refusal(function, *refused);
  std::vector<std::uint8_t> answer = {function, static_cast<std::uint8_t>(2 * count)};
  for (const std::uint16_t value : values) append_big_endian_16(answer, value);
  return answer;
}

// 6.6: function, address, value -> the same.
std::vector<std::uint8_t> write_one(int unit, Bytes request, ModbusUnits& units) {
  if (request.size() != 5) return refusal(request[0], ModbusException::illegal_value);
  const auto value = static_cast<std::uint16_t>(big_endian_16(request, 3));
  if (const auto refused = units.write(unit, big_endian_16(request, 1), {&value, 1})) {
    return refusal(request[0], *refused);
  }
  return {request.begin(), request.end()};
}

// 6.12: function, first, count, byte count, values -> function, first, count.
std::vector<std::uint8_t> write_registers(int unit, Bytes request, ModbusUnits& units) {
  if (request.size() < 6) return refusal(request[0], ModbusException::illegal_value);
  const int first = big_endian_16(request, 1), count = big_endian_16(request, 3);
  if (count < 1 || count > kMaxWrite || request[5] != 2 * count ||
      request.size() != 6 + 2 * static_cast<std::size_t>(count)) {
    return refusal(request[0], ModbusException::illegal_value);
  }
  if (first + count > 65536) return refusal(request[0], ModbusException::illegal_address);
  if (const auto refused = units.refuses(unit, request[0], count)) return refusal(request[0], *refused);
  std::vector<std::uint16_t> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(static_cast<std::uint16_t>(big_endian_16(request, 6 + 2 * static_cast<std::size_t>(i))));
  }
  if (const auto refused = units.write(unit, first, values)) return refusal(request[0], *refused);
  return {request.begin(), request.begin() + 5};
}

// 6.1, 6.2: function, first, count -> function, byte count, bits from the lowest of the first byte on.
std::vector<std::uint8_t> read_bits(int unit, Bytes request, ModbusUnits& units) {
  const std::uint8_t function = request[0];
  if (!units.has_bits(unit)) return refusal(function, ModbusException::illegal_function);
  if (request.size() != 5) return refusal(function, ModbusException::illegal_value);
  const int first = big_endian_16(request, 1), count = big_endian_16(request, 3);
  if (count < 1 || count > kMaxReadBits) return refusal(function, ModbusException::illegal_value);
  if (first + count > 65536) return refusal(function, ModbusException::illegal_address);
  if (const auto refused = units.refuses(unit, function, count)) return refusal(function, *refused);
  std::vector<std::uint16_t> bits(static_cast<std::size_t>(count), 0);
  const RegisterKind kind = function == 1 ? RegisterKind::coil : RegisterKind::discrete;
  if (const auto refused = units.read(unit, kind, first, bits)) return refusal(function, *refused);
  const std::size_t bytes = (bits.size() + 7) / 8;
  std::vector<std::uint8_t> answer(2 + bytes, 0);
  answer[0] = function;
  answer[1] = static_cast<std::uint8_t>(bytes);
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (bits[i] != 0) answer[2 + i / 8] = static_cast<std::uint8_t>(answer[2 + i / 8] | 1u << i % 8);
  return answer;
}

// 6.5: function, address, ff00 or 0000 -> the same.
std::vector<std::uint8_t> write_coil(int unit, Bytes request, ModbusUnits& units) {
  if (!units.has_bits(unit)) return refusal(request[0], ModbusException::illegal_function);
  if (request.size() != 5) return refusal(request[0], ModbusException::illegal_value);
  const int value = big_endian_16(request, 3);
  if (value != 0 && value != kCoilOn) return refusal(request[0], ModbusException::illegal_value);
  const std::uint16_t bit = value == kCoilOn ? 1 : 0;
  if (const auto refused = units.write_coils(unit, big_endian_16(request, 1), {&bit, 1}))
    return refusal(request[0], *refused);
  return {request.begin(), request.end()};
}

// 6.11: function, first, count, byte count, bits -> function, first, count.
std::vector<std::uint8_t> write_coils(int unit, Bytes request, ModbusUnits& units) {
  if (!units.has_bits(unit)) return refusal(request[0], ModbusException::illegal_function);
  if (request.size() < 6) return refusal(request[0], ModbusException::illegal_value);
  const int first = big_endian_16(request, 1), count = big_endian_16(request, 3), bytes = (count + 7) / 8;
  if (count < 1 || count > kMaxWriteBits || request[5] != bytes ||
      request.size() != 6 + static_cast<std::size_t>(bytes)) {
    return refusal(request[0], ModbusException::illegal_value);
  }
  if (first + count > 65536) return refusal(request[0], ModbusException::illegal_address);
  if (const auto refused = units.refuses(unit, request[0], count)) return refusal(request[0], *refused);
  std::vector<std::uint16_t> bits;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) bits.push_back(request[6 + i / 8] >> i % 8 & 1);
  if (const auto refused = units.write_coils(unit, first, bits)) return refusal(request[0], *refused);
  return {request.begin(), request.begin() + 5};
}

}  // namespace

std::vector<std::uint8_t> answer_pdu(int unit, Bytes request, ModbusUnits& units) {
  switch (request[0]) {
    case 1:
    case 2:
      return read_bits(unit, request, units);
    case 5:
      return write_coil(unit, request, units);
    case 15:
      return write_coils(unit, request, units);
    case 3:
    case 4:
      return read_registers(unit, request, units);
    case 6:
      return write_one(unit, request, units);
    case 16:
      return write_registers(unit, request, units);
    default:
      return refusal(request[0], ModbusException::illegal_function);
  }
}

std::vector<ModbusReply> ModbusSession::receive(Bytes bytes, ModbusUnits& units) {
  std::vector<ModbusReply> replies;
  if (broken_) return replies;
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  while (pending_.size() - at >= kHeader) {
    const Bytes rest = Bytes(pending_).subspan(at);
    const int length = big_endian_16(rest, 4);
    if (big_endian_16(rest, 2) != 0 || length < kMinLength || length > kMaxLength) {
      broken_ = true;
      pending_.clear();
      return replies;
    }
    const std::size_t frame = 6 + static_cast<std::size_t>(length);
    if (rest.size() < frame) break;
    const Bytes request = rest.subspan(kHeader, frame - kHeader);
    const int unit = rest[6];
    at += frame;

    std::vector<std::uint8_t> pdu;
    Disturbance disturbance;
    if (!units.has(unit)) {  // a gateway reports a missing unit
      pdu = refusal(request[0], ModbusException::gateway_no_response);
    } else {
      disturbance = units.disturbance(unit);
      if (disturbance.silent) continue;
      pdu = disturbance.exception ? refusal(request[0], *disturbance.exception) : answer_pdu(unit, request, units);
    }
    std::vector<std::uint8_t> reply = {rest[0], rest[1], 0, 0};
    append_big_endian_16(reply, static_cast<int>(pdu.size() + 1));
    reply.push_back(rest[6]);
    reply.insert(reply.end(), pdu.begin(), pdu.end());
    if (disturbance.garbled) reply = garbled_reply(std::move(reply), disturbance.random);
    if (disturbance.duplicated) replies.push_back({reply, disturbance.delay});
    replies.push_back({std::move(reply), disturbance.delay});
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(at));
  return replies;
}

std::vector<std::uint8_t> garbled_reply(std::vector<std::uint8_t> reply, std::uint64_t random) {
  const auto change = static_cast<std::uint8_t>(1 + (random >> 8) % 255);  // never 0, so an xored byte differs
  switch (random % 6) {
    case 0:
      reply[1] ^= change;  // transaction
      break;
    case 1:
      reply[2] ^= change;  // protocol
      break;
    case 2:
      reply[kHeader] ^= static_cast<std::uint8_t>(change & 0x7f ? change & 0x7f : 1);  // function, not an exception
      break;
    case 3:
      // Byte count of a read, address of a write's echo, or code of an exception.
      reply[kHeader + 1] ^= change;
      break;
    case 4:
      reply.resize(kHeader + (random >> 16) % (reply.size() - kHeader));  // truncated
      break;
    default: {  // too long
      const std::size_t extra = 1 + (random >> 16) % 16;
      reply.insert(reply.end(), extra, static_cast<std::uint8_t>(random >> 24));
      reply[5] = static_cast<std::uint8_t>(std::min<std::size_t>(reply.size() - 6, 255));
      break;
    }
  }
  return reply;
}

}  // namespace luxrig::sim
