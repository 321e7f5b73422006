#include "drivers/modbus/modbus_patch_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/rig/register_map/register_map.h"

namespace luxrig {
namespace {

class PatchCheck {
 public:
  PatchCheck(const Rig& rig, std::size_t bus, const ModbusLineRules& rules, std::vector<Problem>& problems)
      : rig_(rig), bus_(bus), rules_(rules), problems_(problems) {}

  void fixture(const Fixture& fixture) {
    const std::string what = fmt::format("fixture \"{}\"", fixture.name);
    const auto* patch = std::get_if<ModbusPatch>(&fixture.patch);
    if (patch == nullptr) {
      report(fixture.in_file,
             fmt::format("{} has a DMX address, but its bus \"{}\" is Modbus", what, rig_.buses[bus_].name),
             "give it unit and register in place of universe and address, or another bus");
      return;
    }
    registers(fixture.in_file, what, patch->unit, patch->holding_register, patch->format.registers);
    if (patch->full_scale_raw < 1 || patch->full_scale_raw > 65535) {
      report(fixture.in_file, fmt::format("{}: full_scale {} does not fit a register", what, patch->full_scale_raw),
             "choose a full_scale in 1…65535");
    }
    if (fixture.moves && !fixture.axes) {
      report(fixture.in_file, fmt::format("{} has pan and tilt, which a Modbus dimmer cannot drive", what),
             "put it on a DMX bus, give it an axes_bus, or leave out its pan and tilt ranges");
    }
    if (patch->map) product(fixture.in_file, what, patch->unit, *patch->map, patch->format.registers, 0);
  }

  void luxmeter(const Luxmeter& meter) {
    const std::string what = fmt::format("luxmeter \"{}\"", meter.name);
    registers(meter.in_file, what, meter.patch.unit, meter.patch.first_register, meter.patch.registers);
    if (meter.patch.map) product(meter.in_file, what, meter.patch.unit, *meter.patch.map, 0, meter.patch.registers);
  }

 private:
  void report(const FilePosition& in_file, std::string what, std::string mend) {
    problems_.push_back({rig_.file.string(), in_file.line, in_file.column, std::move(what), std::move(mend)});
  }

  void registers(const FilePosition& in_file, const std::string& what, int unit, int first, int count) {
    if (unit < rules_.first_unit || unit > rules_.last_unit) {
      report(in_file, fmt::format("{}: unit {} does not exist", what, unit),
             fmt::format("choose a unit in {}…{}", rules_.first_unit, rules_.last_unit));
    } else if (first < 0 || first + count > 65536) {
      report(in_file, fmt::format("{}: register {} does not exist", what, first),
             fmt::format("choose a register in 0…{}", 65536 - count));
    }
  }

  void product(const FilePosition& in_file, const std::string& what, int unit, const RegisterMap& map, int written,
               int read) {
    const auto [other, is_new] = products_.try_emplace(unit, &map);
    if (!is_new && other->second != &map) {
      report(in_file,
             fmt::format("{}: unit {} is \"{}\" here and \"{}\" above", what, unit, map.name, other->second->name),
             "give each product a unit of its own, or both the same register map");
      return;
    }
    if (written > map.largest_write || read > map.largest_read) {
      report(in_file, fmt::format("{}: \"{}\" cannot take its two registers in one request", what, map.name),
             "correct largest_read or largest_write of the register map");
    }
    if (rules_.baud && !map.baud_rates.empty() &&
        std::find(map.baud_rates.begin(), map.baud_rates.end(), *rules_.baud) == map.baud_rates.end()) {
      report(in_file, fmt::format("{}: \"{}\" cannot be set to {} baud", what, map.name, *rules_.baud),
             fmt::format("choose one of {} for the bus", fmt::join(map.baud_rates, ", ")));
    }
    if (written > 0 && map.stops_after && *map.stops_after <= 2 * rules_.refresh) {
      report(in_file,
             fmt::format("{}: \"{}\" goes dark {:g} s after the last write, and unchanged levels are written every "
                         "{:g} s",
                         what, map.name, to_seconds(*map.stops_after), to_seconds(rules_.refresh)),
             "lower refresh_ms of the bus, or set the product up to wait longer");
    }
  }

  const Rig& rig_;
  std::size_t bus_;
  const ModbusLineRules& rules_;
  std::vector<Problem>& problems_;
  std::map<int, const RegisterMap*> products_;
};

}  // namespace

void check_modbus_patches(const Rig& rig, std::size_t bus, const ModbusLineRules& rules,
                          std::vector<Problem>& problems) {
  PatchCheck check(rig, bus, rules, problems);
  for (const Fixture& fixture : rig.fixtures) {
    if (fixture.bus == bus) check.fixture(fixture);
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    if (meter.bus == bus) check.luxmeter(meter);
  }
}

}  // namespace luxrig
