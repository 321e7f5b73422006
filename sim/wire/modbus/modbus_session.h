#pragma once
/// One connection of a Modbus TCP server. Pure: bytes in, answers out.
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

/// The units behind one port, like those of a gateway. Addresses are 0-based; first + count never passes 65536.
class ModbusUnits {
 public:
  virtual ~ModbusUnits() = default;
  [[nodiscard]] virtual bool has(int unit) const = 0;
  /// Fills `values`, or refuses. Only called for units that exist.
  virtual std::optional<ModbusException> read(int unit, RegisterKind kind, int first,
                                              std::span<std::uint16_t> values) = 0;
  /// Writes all of `values` to holding registers, or none.
  virtual std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) = 0;
  /// Whether it supports functions 1, 2, 5 and 15; else exception 1. read() then returns bits as 0 and 1.
  [[nodiscard]] virtual bool has_bits(int unit) const {
    (void)unit;
    return false;
  }
  /// Writes all of `bits` (0 or 1) to coils, or none.
  virtual std::optional<ModbusException> write_coils(int unit, int first, std::span<const std::uint16_t> bits) {
    (void)unit, (void)first, (void)bits;
    return ModbusException::illegal_address;
  }
  /// Whether the product refuses such requests: unknown function, or too many registers.
  [[nodiscard]] virtual std::optional<ModbusException> refuses(int unit, int function, int count) const {
    (void)unit, (void)function, (void)count;
    return std::nullopt;
  }
  /// Faults of the next exchange with this unit.
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
  /// Takes received bytes, in any pieces, and returns the answers in order. After bytes that cannot be Modbus TCP,
  /// broken() is true and it answers no more: the next frame cannot be found, so the server hangs up.
  std::vector<ModbusReply> receive(std::span<const std::uint8_t> bytes, ModbusUnits& units);
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  std::vector<std::uint8_t> pending_;  ///< start of a frame; < 260 bytes between calls
  bool broken_ = false;
};

/// The answer PDU (function and data) to a request PDU (1 byte or more).
[[nodiscard]] std::vector<std::uint8_t> answer_pdu(int unit, std::span<const std::uint8_t> request, ModbusUnits& units);

/// Garbles a whole answer so that it breaks the protocol, in one of several ways: another transaction, protocol,
/// function or byte count, truncated, or too long. It keeps register values: Modbus TCP has no checksum, so a changed
/// value would be a lie (FaultKind::lying) and not a broken answer.
[[nodiscard]] std::vector<std::uint8_t> garbled_reply(std::vector<std::uint8_t> reply, std::uint64_t random);

}  // namespace luxrig::sim
