#include "drivers/modbus/modbus_rtu_driver.h"

#include <fmt/format.h>

#include "drivers/modbus/modbus_driver.h"
#include "drivers/modbus/modbus_patch_check.h"
#include "drivers/modbus/modbus_rtu_link.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kModbusRtuOptions[] = {
    {"device", "text", "", "required", "a path that begins with /",
     "the serial port; names in /dev/serial/by-id stay when adapters are plugged in another order"},
    {"baud", "whole number", "", "19200", "300 to 4000000", "as every unit of the line is set"},
    {"parity", "text", "", "\"even\"", "none, even or odd", "the same; many cheap devices ship with none"},
    {"stop_bits", "whole number", "", "1", "1 to 2", "the same; Modbus wants 2 without parity, most devices have 1"},
    {"rs485", "true or false", "", "false", "",
     "asks the kernel to switch the port's transceiver; USB adapters do it by themselves. A port that cannot goes on "
     "without"},
    {"response_timeout_ms", "whole number", "ms", "200", "20 to 5000",
     "how long a unit may take to answer, beside what the bytes take; a register map with `answer_ms` has its own"},
    {"refresh_ms", "whole number", "ms", "400", "100 to 10000",
     "unchanged dimmer values are written again this often, so that a restarted dimmer gets its level back"},
    {"poll_ms", "whole number", "ms", "200", "20 to 10000", "each luxmeter is read this often"},
    modbus::kContactInputOption,
    modbus::kContactUnitOption,
    modbus::kContactWhenOption,
};

Duration rtu_option_ms(const Bus& bus, std::string_view key) {
  return std::chrono::milliseconds(integer_option(bus, kModbusRtuOptions, key));
}

std::optional<modbus::Parity> parity_named(std::string_view name) {
  if (name == "none") return modbus::Parity::none;
  if (name == "even") return modbus::Parity::even;
  if (name == "odd") return modbus::Parity::odd;
  return std::nullopt;
}

}  // namespace

std::span<const OptionDoc> modbus_rtu_options() { return kModbusRtuOptions; }

std::vector<Problem> check_modbus_rtu(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kModbusRtuOptions);
  ModbusLineRules rules;
  rules.first_unit = 1;  // 0 is the broadcast address, which gets no answer
  rules.last_unit = 247;
  if (problems.empty()) {
    rules.refresh = rtu_option_ms(entry, "refresh_ms");
    rules.baud = static_cast<int>(integer_option(entry, kModbusRtuOptions, "baud"));
    const std::string device = string_option(entry, kModbusRtuOptions, "device");
    if (!device.starts_with('/')) {
      problems.push_back(problem_at(rig, entry, "device", fmt::format("device = \"{}\" is no path", device),
                                    "write the port's full path, such as \"/dev/ttyUSB0\""));
    }
    const std::string parity = string_option(entry, kModbusRtuOptions, "parity");
    if (!parity_named(parity)) {
      problems.push_back(
          problem_at(rig, entry, "parity", fmt::format("parity cannot be \"{}\"", parity), "choose none, even or odd"));
    }
  }
  if (problems.empty())
    problems = modbus::check_contact(rig, entry, kModbusRtuOptions, rules.first_unit, rules.last_unit);
  check_modbus_patches(rig, bus, rules, problems);
  return problems;
}

std::unique_ptr<Driver> make_modbus_rtu(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  const Bus& entry = rig.buses[bus];
  modbus::SerialSettings settings;
  settings.device = string_option(entry, kModbusRtuOptions, "device");
  settings.baud = static_cast<int>(integer_option(entry, kModbusRtuOptions, "baud"));
  settings.parity = parity_named(string_option(entry, kModbusRtuOptions, "parity")).value_or(modbus::Parity::even);
  settings.stop_bits = static_cast<int>(integer_option(entry, kModbusRtuOptions, "stop_bits"));
  settings.rs485 = boolean_option(entry, kModbusRtuOptions, "rs485");
  if (redirect) {
    settings.device = redirect->path;
    settings.parity = modbus::Parity::none;  // a pseudo terminal accepts no other
  }
  ModbusTiming timing;
  timing.response_timeout = std::chrono::milliseconds(integer_option(entry, kModbusRtuOptions, "response_timeout_ms"));
  timing.refresh = rtu_option_ms(entry, "refresh_ms");
  timing.poll = rtu_option_ms(entry, "poll_ms");
  timing.contact = modbus::contact_patch(entry, kModbusRtuOptions);
  return std::make_unique<ModbusDriver>(std::make_unique<modbus::RtuLink>(std::move(settings)), timing, rig, bus);
}

}  // namespace luxrig
