#include "drivers/modbus/modbus_schedule.h"

#include <algorithm>
#include <tuple>

#include "drivers/modbus/modbus_codec.h"

namespace luxrig::modbus {

WriteSchedule::WriteSchedule(const Rig& rig, std::size_t bus, Duration refresh, const std::map<int, UnitRules>& rules)
    : refresh_(refresh) {
  for (const auto& [unit, rule] : rules) largest_[unit] = rule.largest_write;
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (rig.fixtures[i].bus != bus) continue;
    Channel channel;
    channel.fixture = i;
    channel.patch = std::get<ModbusPatch>(rig.fixtures[i].patch);
    channels_.push_back(channel);
  }
  std::stable_sort(channels_.begin(), channels_.end(), [](const Channel& a, const Channel& b) {
    return std::tie(a.patch.unit, a.patch.coil, a.patch.holding_register) <
           std::tie(b.patch.unit, b.patch.coil, b.patch.holding_register);
  });
}

bool WriteSchedule::is_due(const Channel& channel, Time now, const UnitBackoff& units) const {
  if (!channel.wanted || !units.may_ask(channel.patch.unit, now)) return false;
  if (!channel.tried) return true;
  const Duration since = now - *channel.tried;
  return since >= refresh_ || (channel.wanted != channel.confirmed && since >= kShortestRewrite);
}

std::vector<WriteSchedule::Run> WriteSchedule::due(Time now, const UnitBackoff& units) const {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!is_due(channels_[i], now, units)) continue;
    const ModbusPatch& patch = channels_[i].patch;
    const auto registers = static_cast<std::size_t>(patch.format.registers);
    if (!runs.empty() && runs.back().end == i && !single_.contains(patch.unit) &&
        runs.back().registers + registers <= largest_.at(patch.unit)) {
      const ModbusPatch& before = channels_[i - 1].patch;
      if (before.unit == patch.unit && before.coil == patch.coil &&
          before.holding_register + before.format.registers == patch.holding_register) {
        runs.back().end = i + 1;
        runs.back().registers += registers;
        continue;
      }
    }
    runs.push_back(alone(i));
  }
  const auto first = std::find_if(runs.begin(), runs.end(), [&](const Run& run) { return run.begin >= next_; });
  std::rotate(runs.begin(), first, runs.end());
  const auto unit_of = [&](const Run& run) { return channels_[run.begin].patch.unit; };
  const auto silent =
      std::stable_partition(runs.begin(), runs.end(), [&](const Run& run) { return !units.is_silent(unit_of(run)); });
  std::stable_sort(silent, runs.end(),
                   [&](const Run& a, const Run& b) { return units.before(unit_of(a), unit_of(b)); });
  return runs;
}

WriteSchedule::Run WriteSchedule::alone(std::size_t channel) const {
  return {channel, channel + 1, static_cast<std::size_t>(channels_[channel].patch.format.registers)};
}

Request WriteSchedule::request_for(const Run& run) const {
  const ModbusPatch& first = channels_[run.begin].patch;
  Request request;
  request.unit = first.unit;
  if (first.coil)
    request.function = run.registers == 1 ? Function::write_coil : Function::write_coils;
  else
    request.function = run.registers == 1 ? Function::write_single : Function::write_multiple;
  request.first_register = first.holding_register;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    const RegisterWords& words = *channels_[i].wanted;
    request.values.insert(request.values.end(), words.word.begin(),
                          words.word.begin() + static_cast<std::ptrdiff_t>(words.count));
  }
  return request;
}

void WriteSchedule::tried(const Run& run, Time now) {
  for (std::size_t i = run.begin; i < run.end; ++i) channels_[i].tried = now;
  next_ = run.end;
}

void WriteSchedule::confirmed(const Run& run) {
  for (std::size_t i = run.begin; i < run.end; ++i) channels_[i].confirmed = channels_[i].wanted;
}

bool WriteSchedule::all_confirmed() const {
  return std::all_of(channels_.begin(), channels_.end(), [](const Channel& c) { return c.wanted == c.confirmed; });
}

void WriteSchedule::forget() {
  for (Channel& channel : channels_) {
    channel.confirmed.reset();
    channel.tried.reset();
  }
}

}  // namespace luxrig::modbus
