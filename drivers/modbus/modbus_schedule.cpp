#include "drivers/modbus/modbus_schedule.h"

#include <algorithm>
#include <tuple>

#include "drivers/modbus/modbus_codec.h"

namespace luxrig::modbus {

constexpr Duration kAskSilentUnitEvery = std::chrono::seconds(1);

bool UnitBackoff::may_ask(int unit, Time now) const {
  const auto found = retry_at_.find(unit);
  return found == retry_at_.end() || now >= found->second;
}
void UnitBackoff::answered(int unit) { retry_at_.erase(unit); }
void UnitBackoff::silent(int unit, Time now) { retry_at_[unit] = now + kAskSilentUnitEvery; }
bool UnitBackoff::is_silent(int unit) const { return retry_at_.contains(unit); }

WriteSchedule::WriteSchedule(const Rig& rig, std::size_t bus, Duration refresh) : refresh_(refresh) {
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (rig.fixtures[i].bus != bus) continue;
    Channel channel;
    channel.fixture = i;
    channel.patch = std::get<ModbusPatch>(rig.fixtures[i].patch);
    channels_.push_back(channel);
  }
  std::stable_sort(channels_.begin(), channels_.end(), [](const Channel& a, const Channel& b) {
    return std::tie(a.patch.unit, a.patch.holding_register) < std::tie(b.patch.unit, b.patch.holding_register);
  });
}

bool WriteSchedule::is_due(const Channel& channel, Time now, const UnitBackoff& units) const {
  if (!channel.wanted_raw || !units.may_ask(channel.patch.unit, now)) return false;
  if (!channel.tried) return true;
  const Duration since = now - *channel.tried;
  return since >= refresh_ || (channel.wanted_raw != channel.confirmed_raw && since >= kShortestRewrite);
}

std::vector<WriteSchedule::Run> WriteSchedule::due(Time now, const UnitBackoff& units) const {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!is_due(channels_[i], now, units)) continue;
    const ModbusPatch& patch = channels_[i].patch;
    if (!runs.empty() && runs.back().end == i && runs.back().size() < kMostWriteRegisters &&
        !single_.contains(patch.unit)) {
      const ModbusPatch& before = channels_[i - 1].patch;
      if (before.unit == patch.unit && before.holding_register + 1 == patch.holding_register) {
        runs.back().end = i + 1;
        continue;
      }
    }
    runs.push_back({i, i + 1});
  }
  const auto first = std::find_if(runs.begin(), runs.end(), [&](const Run& run) { return run.begin >= next_; });
  std::rotate(runs.begin(), first, runs.end());
  std::stable_partition(runs.begin(), runs.end(),
                        [&](const Run& run) { return !units.is_silent(channels_[run.begin].patch.unit); });
  return runs;
}

void WriteSchedule::tried(const Run& run, Time now) {
  for (std::size_t i = run.begin; i < run.end; ++i) channels_[i].tried = now;
  next_ = run.end;
}

void WriteSchedule::confirmed(const Run& run) {
  for (std::size_t i = run.begin; i < run.end; ++i) channels_[i].confirmed_raw = channels_[i].wanted_raw;
}

void WriteSchedule::forget() {
  for (Channel& channel : channels_) {
    channel.confirmed_raw.reset();
    channel.tried.reset();
  }
}

}  // namespace luxrig::modbus
