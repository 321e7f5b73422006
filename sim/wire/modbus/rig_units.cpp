#include "sim/wire/modbus/rig_units.h"

#include <algorithm>
#include <cmath>

#include "sim/wire/modbus/line_numbers.h"

namespace luxrig::sim {
namespace {

RegisterKind kind_of(RegisterTable table) {
  switch (table) {
    case RegisterTable::holding:
      return RegisterKind::holding;
    case RegisterTable::input:
      return RegisterKind::input;
    case RegisterTable::coil:
      return RegisterKind::coil;
    case RegisterTable::discrete:
      return RegisterKind::discrete;
  }
  return RegisterKind::holding;
}

constexpr Duration kSlowClock = std::chrono::milliseconds(2);  // a gap that is almost over counts as over

}  // namespace

RigUnits::RigUnits(const EndpointParts& parts) : parts_(parts) {
  const Rig& rig = parts.rig;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const auto* patch = std::get_if<ModbusPatch>(&rig.fixtures[f].patch);
    if (rig.fixtures[f].bus != parts.bus || patch == nullptr) continue;
    unit_of(patch->unit, rig.fixtures[f].name, patch->map);
    Number number{Number::Is::dimmer, f, patch->format, static_cast<double>(patch->dark_raw),
                  static_cast<double>(patch->full_scale_raw)};
    add(patch->unit, patch->coil ? RegisterKind::coil : RegisterKind::holding, patch->holding_register, number);
  }
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    if (rig.luxmeters[m].bus != parts.bus) continue;
    const ModbusMeterPatch& patch = rig.luxmeters[m].patch;
    unit_of(patch.unit, rig.luxmeters[m].name, patch.map);
    Number number{Number::Is::meter, m, patch.format()};
    number.writable = false;
    add(patch.unit, patch.input_registers ? RegisterKind::input : RegisterKind::holding, patch.first_register, number);
  }
  add_contact();
  for (auto& [id, unit] : units_) {
    if (!unit.map) continue;
    std::vector<std::size_t> number_of;  // by register of the map
    for (const MappedRegister& reg : unit.map->registers) {
      const RegisterKind kind = kind_of(reg.table);
      const auto there = places_.find({id, kind, reg.address});
      if (there == places_.end()) {
        Number number;
        number.format = reg.format;
        const bool is_float = reg.format.number == RegisterNumber::floating;
        number.least = reg.range_raw ? reg.range_raw->first : is_float ? -1e38 : -4294967296.0;
        number.most = reg.range_raw ? reg.range_raw->second : is_float ? 1e38 : 4294967296.0;
        number_of.push_back(add(id, kind, reg.address, number));
      } else {
        number_of.push_back(there->second.number);
      }
      Number& number = numbers_[number_of.back()];
      number.readable = reg.access != RegisterAccess::write_only;
      number.writable = reg.access != RegisterAccess::read_only && number.is != Number::Is::meter;
      number.power_on = reg.power_on_raw;
      if (reg.role != RegisterRole::failure) continue;
      number.is = Number::Is::failure;
      const auto bit = static_cast<std::size_t>(&reg - unit.map->registers.data());
      for (const std::size_t level : unit.map->with_role(RegisterRole::level)) {
        const MappedRegister& output = unit.map->registers[level];
        const auto at = places_.find({id, kind_of(output.table), output.address});
        if (at == places_.end() || numbers_[at->second.number].is != Number::Is::dimmer) continue;
        if (unit.map->concerns(bit, level))
          number.about.push_back(rig.fixtures[numbers_[at->second.number].index].name);
      }
    }
    for (const SetupWrite& write : unit.map->setup) unit.setup.emplace_back(number_of[write.index], write.value_raw);
  }
  for (auto& [id, unit] : units_) power_on(unit);
}

/// Adds the bus's blackout contact, a switch on a discrete input, if it has one.
void RigUnits::add_contact() {
  const Bus& bus = parts_.rig.buses[parts_.bus];
  const auto whole = [&](const char* key, std::int64_t otherwise) {
    const auto found = bus.options.find(key);
    const auto* number = found == bus.options.end() ? nullptr : std::get_if<std::int64_t>(&found->second.value);
    return static_cast<int>(number != nullptr ? *number : otherwise);
  };
  const int input = whole("blackout_input", -1), unit = whole("blackout_unit", 1);
  if (input < 0) return;
  const auto when = bus.options.find("blackout_when");
  closed_when_pressed_ = when != bus.options.end() && when->second.value == OptionValue(std::string("closed"));
  unit_of(unit, bus.name, nullptr);
  Number number;
  number.is = Number::Is::contact;
  number.writable = false;
  add(unit, RegisterKind::discrete, input, number);
}

RigUnits::Unit& RigUnits::unit_of(int unit, const std::string& device, const std::shared_ptr<const RegisterMap>& map) {
  Unit& made = units_[unit];
  if (made.devices.empty()) made.devices.push_back(parts_.rig.buses[parts_.bus].name);
  made.devices.push_back(device);
  if (map) made.map = map;
  return made;
}

std::size_t RigUnits::add(int unit, RegisterKind kind, int first, Number number) {
  number.words.assign(static_cast<std::size_t>(number.format.registers), 0);
  for (std::size_t word = 0; word < number.words.size(); ++word) {
    places_[{unit, kind, first + static_cast<int>(word)}] = {numbers_.size(), word};
  }
  numbers_.push_back(std::move(number));
  units_[unit].numbers.push_back(numbers_.size() - 1);
  return numbers_.size() - 1;
}

void RigUnits::show(const Number& number) {
  if (number.is != Number::Is::dimmer) return;
  const double level = (number_from(number.words, number.format) - number.least) / (number.most - number.least);
  parts_.world.set_drive(number.index, std::isfinite(level) ? std::clamp(level, 0.0, 1.0) : 0.0);
}

void RigUnits::power_on(Unit& unit) {
  unit.powered = true;
  unit.dark = false;
  unit.heard = false;
  for (const std::size_t n : unit.numbers) {
    numbers_[n].words = registers_from(numbers_[n].power_on, numbers_[n].format);
    show(numbers_[n]);
  }
}

void RigUnits::go_dark(Unit& unit) {
  unit.dark = true;
  for (const std::size_t n : unit.numbers) {
    if (numbers_[n].is != Number::Is::dimmer) continue;
    numbers_[n].words = registers_from(numbers_[n].least, numbers_[n].format);
    show(numbers_[n]);
  }
}

bool RigUnits::data_loss_armed(const Unit& unit) const {
  if (!unit.map || !unit.map->stops_after || unit.map->when_data_stops == DataLoss::hold) return false;
  if (unit.map->when_data_stops == DataLoss::dark) return true;
  return std::all_of(unit.setup.begin(), unit.setup.end(), [&](const auto& wanted) {
    const Number& number = numbers_[wanted.first];
    return number_from(number.words, number.format) == wanted.second;
  });
}

void RigUnits::switch_power(Unit& unit) {
  const bool cut = std::any_of(unit.devices.begin(), unit.devices.end(), [&](const std::string& device) {
    return parts_.faults.find(device, FaultKind::unpowered).has_value();
  });
  if (cut && unit.powered) {
    go_dark(unit);
    unit.powered = false;
  } else if (!cut && !unit.powered) {
    power_on(unit);
  }
}

void RigUnits::advance(Time now) {
  now_ = now;
  lamp_faults_.obey(parts_.rig, parts_.bus, parts_.faults, parts_.world);
  if (const std::uint64_t revision = parts_.faults.revision(); revision != faults_seen_) {
    faults_seen_ = revision;
    for (auto& [id, unit] : units_) switch_power(unit);
  }
  for (auto& [id, unit] : units_) {
    if (unit.powered && unit.heard && !unit.dark && data_loss_armed(unit) &&
        now - unit.last_heard >= *unit.map->stops_after) {
      go_dark(unit);
    }
  }
}

double RigUnits::meter_count(const Number& number) {
  const Luxmeter& meter = parts_.rig.luxmeters[number.index];
  return parts_.faults.shown_lx(meter.name, parts_.world.meter_reading_lx(number.index)) / meter.patch.lux_per_count;
}

std::optional<ModbusException> RigUnits::read(int unit, RegisterKind kind, int first, std::span<std::uint16_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto place = places_.find({unit, kind, first + static_cast<int>(i)});
    if (place == places_.end()) return ModbusException::illegal_address;
    Number& number = numbers_[place->second.number];
    if (!number.readable) return ModbusException::illegal_address;
    // Both words of a meter belong to one moment: the second comes from the sample of the first.
    if (number.is == Number::Is::meter && (place->second.word == 0 || i == 0)) {
      number.words = registers_from(meter_count(number), number.format);
    }
    if (number.is == Number::Is::failure) {
      number.words[0] = std::any_of(number.about.begin(), number.about.end(), [&](const std::string& fixture) {
        return parts_.faults.find(fixture, FaultKind::lamp_failure).has_value();
      });
    }
    if (number.is == Number::Is::contact) {
      const bool pressed = parts_.faults.find(parts_.rig.buses[parts_.bus].name, FaultKind::pressed).has_value();
      number.words[0] = pressed == closed_when_pressed_;
    }
    values[i] = number.words[place->second.word];
  }
  return std::nullopt;
}

bool RigUnits::has_bits(int unit) const {
  const auto bit = [unit](const auto& entry) {
    return entry.first.unit == unit &&
           (entry.first.kind == RegisterKind::coil || entry.first.kind == RegisterKind::discrete);
  };
  return std::any_of(places_.begin(), places_.end(), bit);
}

std::optional<ModbusException> RigUnits::write(int unit, int first, std::span<const std::uint16_t> values) {
  return write_table(unit, RegisterKind::holding, first, values);
}

std::optional<ModbusException> RigUnits::write_coils(int unit, int first, std::span<const std::uint16_t> bits) {
  return write_table(unit, RegisterKind::coil, first, bits);
}

std::optional<ModbusException> RigUnits::write_table(int unit, RegisterKind kind, int first,
                                                     std::span<const std::uint16_t> values) {
  std::map<std::size_t, std::vector<std::uint16_t>> changed;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto place = places_.find({unit, kind, first + static_cast<int>(i)});
    if (place == places_.end() || !numbers_[place->second.number].writable) return ModbusException::illegal_address;
    const auto [words, is_new] = changed.try_emplace(place->second.number, numbers_[place->second.number].words);
    words->second[place->second.word] = values[i];
  }
  for (const auto& [n, words] : changed) {
    const double value = number_from(words, numbers_[n].format);
    if (!(value >= numbers_[n].least && value <= numbers_[n].most)) return ModbusException::illegal_value;
  }
  for (const auto& [n, words] : changed) {
    numbers_[n].words = words;
    show(numbers_[n]);
  }
  units_.at(unit).dark = false;
  return std::nullopt;
}

std::optional<ModbusException> RigUnits::refuses(int unit, int function, int count) const {
  const auto found = units_.find(unit);
  if (found == units_.end() || !found->second.map) return std::nullopt;
  const RegisterMap& map = *found->second.map;
  if ((function == 16 || function == 15) && map.largest_write == 1) return ModbusException::illegal_function;
  const int most = function == 16 || function == 15 ? map.largest_write : map.largest_read;
  return count > most ? std::optional(ModbusException::illegal_value) : std::nullopt;
}

Disturbance RigUnits::disturbance(int unit) {
  const auto found = units_.find(unit);
  if (found == units_.end()) return {};
  Unit& asked = found->second;
  Disturbance disturbance = parts_.faults.disturbance(asked.devices, exchanges_++);
  if (asked.map && asked.heard && now_ - asked.last_heard + kSlowClock < asked.map->shortest_gap) {
    disturbance.silent = true;  // busy with the request before
    return disturbance;
  }
  if (!disturbance.silent) {
    asked.last_heard = now_;
    asked.heard = true;
  }
  return disturbance;
}

}  // namespace luxrig::sim
