#include "sim/wire/modbus/rig_units.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {

RigUnits::RigUnits(const EndpointParts& parts) : parts_(parts) {
  const Rig& rig = parts.rig;
  const auto name_device = [&](int unit, const std::string& device) {
    auto& names = devices_of_unit_[unit];
    if (names.empty()) names.push_back(rig.buses[parts.bus].name);
    names.push_back(device);
  };
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const auto* patch = std::get_if<ModbusPatch>(&rig.fixtures[f].patch);
    if (rig.fixtures[f].bus != parts.bus || patch == nullptr) continue;
    registers_[{patch->unit, RegisterKind::holding, patch->holding_register}] = {false, f, false, 0};
    name_device(patch->unit, rig.fixtures[f].name);
  }
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    if (rig.luxmeters[m].bus != parts.bus) continue;
    const ModbusMeterPatch& patch = rig.luxmeters[m].patch;
    const RegisterKind kind = patch.input_registers ? RegisterKind::input : RegisterKind::holding;
    for (int word = 0; word < patch.registers; ++word) {
      const bool high = patch.registers == 2 && (word == 0) != patch.low_word_first;
      registers_[{patch.unit, kind, patch.first_register + word}] = {true, m, high, 0};
    }
    name_device(patch.unit, rig.luxmeters[m].name);
  }
}

std::uint16_t RigUnits::value_of(const Register& reg) {
  if (!reg.meter) return reg.written;
  const Luxmeter& meter = parts_.rig.luxmeters[reg.index];
  const double lux = parts_.faults.shown_lx(meter.name, parts_.world.meter_reading_lx(reg.index));
  const double most = meter.patch.registers == 2 ? 4294967295.0 : 65535.0;  // a counter that is full stays full
  const auto counts = static_cast<std::uint32_t>(std::clamp(std::round(lux / meter.patch.lux_per_count), 0.0, most));
  return static_cast<std::uint16_t>(reg.high_word ? counts >> 16 : counts & 0xffff);
}

std::optional<ModbusException> RigUnits::read(int unit, RegisterKind kind, int first, std::span<std::uint16_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto found = registers_.find({unit, kind, first + static_cast<int>(i)});
    if (found == registers_.end()) return ModbusException::illegal_address;
    values[i] = value_of(found->second);
  }
  return std::nullopt;
}

std::optional<ModbusException> RigUnits::write(int unit, int first, std::span<const std::uint16_t> values) {
  std::vector<Register*> targets;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto found = registers_.find({unit, RegisterKind::holding, first + static_cast<int>(i)});
    if (found == registers_.end() || found->second.meter) return ModbusException::illegal_address;
    targets.push_back(&found->second);
    if (values[i] > std::get<ModbusPatch>(parts_.rig.fixtures[found->second.index].patch).full_scale_raw) {
      return ModbusException::illegal_value;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    targets[i]->written = values[i];
    const auto& patch = std::get<ModbusPatch>(parts_.rig.fixtures[targets[i]->index].patch);
    parts_.world.set_drive(targets[i]->index, static_cast<double>(values[i]) / patch.full_scale_raw);
  }
  return std::nullopt;
}

Disturbance RigUnits::disturbance(int unit) {
  const auto found = devices_of_unit_.find(unit);
  if (found == devices_of_unit_.end()) return {};
  return parts_.faults.disturbance(found->second, exchanges_++);
}

}  // namespace luxrig::sim
