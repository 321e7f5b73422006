#pragma once
/// The Modbus units of one bus of a rig: dimmer channels, luxmeters, and the other registers in their products'
/// register maps. Any other register gives exception 2.
///
/// A unit with a register map has its limits. It refuses requests that the product does not accept, and ignores one
/// that comes before its gap is over. Its levels go dark after the stated time without requests (with a watchdog, once
/// every register of its set-up holds the set-up's value).

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/rig/register_map/register_map.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/wire/modbus/modbus_session.h"

namespace luxrig::sim {

class RigUnits final : public ModbusUnits {
 public:
  explicit RigUnits(const EndpointParts& parts);

  /// Call it before serving requests: handles watchdog timeouts and power changes.
  void advance(Time now);

  [[nodiscard]] bool has(int unit) const override { return units_.contains(unit); }
  std::optional<ModbusException> read(int unit, RegisterKind kind, int first, std::span<std::uint16_t> values) override;
  [[nodiscard]] bool has_bits(int unit) const override;
  std::optional<ModbusException> write_coils(int unit, int first, std::span<const std::uint16_t> bits) override;
  /// Exception 3 for a value that its product does not accept; then nothing is written.
  std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) override;
  [[nodiscard]] std::optional<ModbusException> refuses(int unit, int function, int count) const override;
  /// Faults of the bus and of every device of that unit.
  Disturbance disturbance(int unit) override;

 private:
  struct Address {
    int unit;
    RegisterKind kind;
    int number;
    auto operator<=>(const Address&) const = default;
  };
  /// One or two registers that form one number.
  struct Number {
    enum class Is { dimmer, meter, failure, contact, other } is = Is::other;
    std::size_t index = 0;  ///< fixture or luxmeter of the rig
    RegisterFormat format;
    double least = 0, most = 65535;
    bool readable = true, writable = true;
    std::vector<std::uint16_t> words{};  ///< present content of its registers
    double power_on = 0;
    std::vector<std::string> about{};  ///< fixtures of a failure bit
  };
  struct WordOfNumber {
    std::size_t number = 0;  ///< in numbers_
    std::size_t word = 0;
  };
  struct Unit {
    std::vector<std::string> devices;  ///< names; the bus first
    std::shared_ptr<const RegisterMap> map;
    std::vector<std::pair<std::size_t, double>> setup;  ///< number, value it must hold
    std::vector<std::size_t> numbers;
    Time last_heard{};
    bool heard = false, powered = true, dark = false;
  };

  Unit& unit_of(int unit, const std::string& device, const std::shared_ptr<const RegisterMap>& map);
  void add_contact();
  std::size_t add(int unit, RegisterKind kind, int first, Number number);
  std::optional<ModbusException> write_table(int unit, RegisterKind kind, int first,
                                             std::span<const std::uint16_t> values);
  void show(const Number& number);
  void power_on(Unit& unit);
  void go_dark(Unit& unit);
  void switch_power(Unit& unit);
  [[nodiscard]] bool data_loss_armed(const Unit& unit) const;
  [[nodiscard]] double meter_count(const Number& number);

  EndpointParts parts_;
  bool closed_when_pressed_ = false;  ///< state of the blackout contact
  LampFaults lamp_faults_;
  std::vector<Number> numbers_;
  std::map<Address, WordOfNumber> places_;
  std::map<int, Unit> units_;
  Time now_{};
  std::uint64_t exchanges_ = 0, faults_seen_ = 0;
};

}  // namespace luxrig::sim
