#pragma once
/// One connection of a Modbus TCP server. Pure: bytes come in, answers come out.
/// Source: MODBUS Application Protocol V1.1b3 and Messaging on TCP/IP V1.0b; functions 1 to 6, 15 and 16.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/faults/faults.h"

namespace luxrig::sim {

enum class ModbusException : std::uint8_t {
  illegal_function = 1,
  illegal_address = 2,
  illegal_value = 3,
  gateway_no_response = 11
};

enum class RegisterKind { holding, input, coil, discrete };

/// The units behind one port, as a gateway has them. Addresses are 0-based; first + count never passes 65536.
class ModbusUnits {
 public:
  virtual ~ModbusUnits() = default;
  [[nodiscard]] virtual bool has(int unit) const = 0;
  /// Fills `values`, or refuses. Called for units it has.
  virtual std::optional<ModbusException> read(int unit, RegisterKind kind, int first,
                                              std::span<std::uint16_t> values) = 0;
  /// Writes all of `values` to holding registers, or none.
  virtual std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) = 0;
  /// Whether it knows functions 1, 2, 5 and 15 at all; else exception 1. read() is then asked for bits, as 0 and 1.
  [[nodiscard]] virtual bool has_bits(int unit) const {
    (void)unit;
    return false;
  }
  /// Writes all of `bits` (0 or 1) to coils, or none.
  virtual std::optional<ModbusException> write_coils(int unit, int first, std::span<const std::uint16_t> bits) {
    (void)unit, (void)first, (void)bits;
    return ModbusException::illegal_address;
  }
  /// Whether the product refuses requests of this kind: a function it does not know, more registers than it takes.
  [[nodiscard]] virtual std::optional<ModbusException> refuses(int unit, int function, int count) const {
    (void)unit, (void)function, (void)count;
    return std::nullopt;
  }
  /// How the next exchange with this unit goes wrong.
  virtual Disturbance disturbance(int unit) {
    (void)unit;
    return {};
  }
};

struct ModbusReply {
  std::vector<std::uint8_t> bytes;
  Duration delay{};
};

class ModbusSession {
 public:
  /// Takes what has arrived, in whatever pieces, and returns the answers in order. After bytes that cannot be Modbus
  /// TCP broken() is true and no more is answered: there is no way to find the next frame, so the server hangs up.
  std::vector<ModbusReply> receive(std::span<const std::uint8_t> bytes, ModbusUnits& units);
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  std::vector<std::uint8_t> pending_;  ///< start of a frame; < 260 bytes between calls
  bool broken_ = false;
};

/// The answer PDU (function and data) to a request PDU (1 byte or more).
[[nodiscard]] std::vector<std::uint8_t> answer_pdu(int unit, std::span<const std::uint8_t> request, ModbusUnits& units);

/// A whole answer spoiled so that it breaks the protocol, in one of several ways: another transaction, protocol,
/// function or byte count, cut short, or too long. Register values are left alone: Modbus TCP has no checksum, so a
/// changed value would be a lie (FaultKind::lying) and not a broken answer.
[[nodiscard]] std::vector<std::uint8_t> garbled_reply(std::vector<std::uint8_t> reply, std::uint64_t random);

}  // namespace luxrig::sim
