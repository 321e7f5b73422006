#pragma once
/// The Modbus units of one bus of a rig: dimmer channels behind holding registers, luxmeters behind register pairs.
/// Only registers that the rig file names exist; anything else is exception 2.

#include <map>
#include <string>
#include <vector>

#include "sim/wire/bus_endpoint.h"
#include "sim/wire/modbus/modbus_session.h"

namespace luxrig::sim {

class RigUnits final : public ModbusUnits {
 public:
  explicit RigUnits(const EndpointParts& parts);

  [[nodiscard]] bool has(int unit) const override { return devices_of_unit_.contains(unit); }
  std::optional<ModbusException> read(int unit, RegisterKind kind, int first, std::span<std::uint16_t> values) override;
  /// Exception 3 for a value above a dimmer's full scale.
  std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) override;
  /// Of the bus and of every device of that unit.
  Disturbance disturbance(int unit) override;

 private:
  struct Address {
    int unit;
    RegisterKind kind;
    int number;
    auto operator<=>(const Address&) const = default;
  };
  struct Register {
    bool meter = false;
    std::size_t index = 0;      ///< fixture or luxmeter of the rig
    bool high_word = false;     ///< of a meter's 32 bits
    std::uint16_t written = 0;  ///< by the master, to a dimmer
  };

  [[nodiscard]] std::uint16_t value_of(const Register& reg);

  EndpointParts parts_;
  std::map<Address, Register> registers_;
  std::map<int, std::vector<std::string>> devices_of_unit_;  ///< names; the bus first
  std::uint64_t exchanges_ = 0;
};

}  // namespace luxrig::sim
