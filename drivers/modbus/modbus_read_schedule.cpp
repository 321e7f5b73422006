#include <algorithm>
#include <tuple>

#include "drivers/modbus/modbus_schedule.h"

namespace luxrig::modbus {
namespace {

// Calls rarely come at the exact time. A meter due slightly later is read now, or it would wait for one more call.
constexpr int kEarlyShare = 8;

}  // namespace

ReadSchedule::ReadSchedule(const Rig& rig, std::size_t bus, Duration poll, const std::map<int, UnitRules>& rules)
    : poll_(poll) {
  for (const auto& [unit, rule] : rules) largest_[unit] = rule.largest_read;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (rig.luxmeters[i].bus == bus) meters_.push_back(i);
  }
  const auto in_file = [&](std::size_t meter) {
    const ModbusMeterPatch& patch = rig.luxmeters[meter].patch;
    return std::make_tuple(patch.unit, patch.input_registers, patch.first_register);
  };
  std::stable_sort(meters_.begin(), meters_.end(),
                   [&](std::size_t a, std::size_t b) { return in_file(a) < in_file(b); });
  for (const std::size_t meter : meters_) patches_.push_back(rig.luxmeters[meter].patch);
  due_at_.resize(meters_.size());
}

std::vector<ReadSchedule::Batch> ReadSchedule::due(Time now, const UnitBackoff& units) const {
  std::vector<Batch> batches;
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    const ModbusMeterPatch& patch = patches_[i];
    if (due_at_[i] && now + poll_ / kEarlyShare < *due_at_[i]) continue;
    if (!units.may_ask(patch.unit, now)) continue;
    const auto registers = static_cast<std::size_t>(patch.registers);
    const Function function = patch.input_registers ? Function::read_input : Function::read_holding;
    if (!batches.empty() && batches.back().end == i && !single_.contains(patch.unit)) {
      Request& before = batches.back().request;
      if (before.unit == patch.unit && before.function == function &&
          before.first_register + static_cast<int>(before.count) == patch.first_register &&
          before.count + registers <= largest_.at(patch.unit)) {
        batches.back().end = i + 1;
        before.count += registers;
        continue;
      }
    }
    batches.push_back({i, i + 1, {patch.unit, function, patch.first_register, registers, {}}});
  }
  const auto first =
      std::find_if(batches.begin(), batches.end(), [&](const Batch& batch) { return batch.begin >= next_; });
  std::rotate(batches.begin(), first, batches.end());
  const auto silent = std::stable_partition(batches.begin(), batches.end(),
                                            [&](const Batch& batch) { return !units.is_silent(batch.request.unit); });
  std::stable_sort(silent, batches.end(),
                   [&](const Batch& a, const Batch& b) { return units.before(a.request.unit, b.request.unit); });
  return batches;
}

void ReadSchedule::asked(const Batch& batch, Time now) {
  for (std::size_t i = batch.begin; i < batch.end; ++i) {
    due_at_[i] = std::max(due_at_[i].value_or(now), now - poll_ / 2) + poll_;
  }
  next_ = batch.end;
}

void ReadSchedule::forget() { std::fill(due_at_.begin(), due_at_.end(), std::nullopt); }

}  // namespace luxrig::modbus
