#include "drivers/modbus/modbus_failure_bits.h"

#include <algorithm>
#include <tuple>

#include "core/rig/register_map/register_map.h"

namespace luxrig::modbus {

FailureBits::FailureBits(const std::map<int, UnitRules>& rules, std::span<const Channel> channels) {
  for (const auto& [unit, rule] : rules) {
    if (!rule.map) continue;
    const RegisterMap& map = *rule.map;
    largest_[unit] = rule.largest_read;
    for (const std::size_t failure : map.with_role(RegisterRole::failure)) {
      const MappedRegister& reg = map.registers[failure];
      Bit bit{unit, reg.address, reg.table == RegisterTable::discrete, reg.name, {}, false, {}};
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const ModbusPatch& patch = channels[c].patch;
        if (patch.unit != unit) continue;
        for (const std::size_t level : map.with_role(RegisterRole::level)) {
          const MappedRegister& output = map.registers[level];
          if (output.address == patch.holding_register && (output.table == RegisterTable::coil) == patch.coil &&
              map.concerns(failure, level))
            bit.channels.push_back(c);
        }
      }
      if (!bit.channels.empty()) bits_.push_back(std::move(bit));
    }
  }
  std::sort(bits_.begin(), bits_.end(), [](const Bit& a, const Bit& b) {
    return std::tie(a.unit, a.discrete, a.address) < std::tie(b.unit, b.discrete, b.address);
  });
}

std::vector<FailureBits::Batch> FailureBits::due(Time now, const UnitBackoff& units) const {
  std::vector<Batch> batches;
  for (std::size_t i = 0; i < bits_.size(); ++i) {
    const Bit& bit = bits_[i];
    if (bit.asked && now - *bit.asked < kFailuresEvery) continue;
    if (units.is_silent(bit.unit)) continue;  // its levels will show whether it is back
    const Function function = bit.discrete ? Function::read_discrete : Function::read_coils;
    if (!batches.empty() && batches.back().end == i) {
      Request& before = batches.back().request;
      if (before.unit == bit.unit && before.function == function &&
          before.first_register + static_cast<int>(before.count) == bit.address &&
          before.count < largest_.at(bit.unit)) {
        batches.back().end = i + 1;
        ++before.count;
        continue;
      }
    }
    batches.push_back({i, i + 1, {bit.unit, function, bit.address, 1, {}}});
  }
  return batches;
}

void FailureBits::asked(const Batch& batch, Time now) {
  for (std::size_t i = batch.begin; i < batch.end; ++i) bits_[i].asked = now;
}

void FailureBits::answered(const Batch& batch, std::span<const std::uint16_t> bits) {
  for (std::size_t i = batch.begin; i < batch.end; ++i) bits_[i].set = bits[i - batch.begin] != 0;
}

void FailureBits::forget(int unit) {
  for (Bit& bit : bits_) {
    if (bit.unit != unit) continue;
    bit.set = false;
    bit.asked.reset();
  }
}

void FailureBits::forget() {
  for (Bit& bit : bits_) {
    bit.set = false;
    bit.asked.reset();
  }
}

std::string FailureBits::of_channel(std::size_t channel) const {
  std::string names;
  for (const Bit& bit : bits_) {
    if (!bit.set || std::find(bit.channels.begin(), bit.channels.end(), channel) == bit.channels.end()) continue;
    names += (names.empty() ? "" : ", ") + bit.name;
  }
  return names;
}

}  // namespace luxrig::modbus
