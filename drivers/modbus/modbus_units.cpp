#include "drivers/modbus/modbus_units.h"

#include <algorithm>

#include "core/rig/register_map/register_map.h"

namespace luxrig::modbus {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAdapterSlack(30);  // USB adapters and a busy machine
constexpr Duration kLongestPause = std::chrono::seconds(2);
constexpr Duration kSecondPause = std::chrono::seconds(1);

}  // namespace

std::map<int, UnitRules> unit_rules(const Rig& rig, std::size_t bus, milliseconds response_timeout,
                                    bool behind_gateway, std::optional<int> contact_unit) {
  std::map<int, UnitRules> rules;
  const auto add = [&](int unit, const std::shared_ptr<const RegisterMap>& map) {
    UnitRules& unit_rule = rules.try_emplace(unit).first->second;
    if (unit_rule.timeout == milliseconds(0)) unit_rule.timeout = response_timeout;
    if (!map) return;
    unit_rule.map = map;
    unit_rule.gap = std::chrono::ceil<milliseconds>(map->shortest_gap);
    unit_rule.largest_read = static_cast<std::size_t>(map->largest_read);
    unit_rule.largest_write = static_cast<std::size_t>(map->largest_write);
    if (!map->answer_time) return;
    const milliseconds answer = std::chrono::ceil<milliseconds>(*map->answer_time) + kAdapterSlack;
    unit_rule.timeout = behind_gateway ? std::max(answer, response_timeout) : answer;
  };
  for (const Fixture& fixture : rig.fixtures) {
    const auto* patch = std::get_if<ModbusPatch>(&fixture.patch);
    if (fixture.bus == bus && patch != nullptr) add(patch->unit, patch->map);
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    if (meter.bus == bus) add(meter.patch.unit, meter.patch.map);
  }
  if (contact_unit) add(*contact_unit, nullptr);
  return rules;
}

bool UnitBackoff::may_ask(int unit, Time now) const {
  const auto found = silent_.find(unit);
  if (found == silent_.end()) return true;
  return now >= found->second.retry_at && now + kProbeShare * kProbeCredit >= paid_until_;
}

bool UnitBackoff::before(int a, int b) const {
  const auto first = silent_.find(a), second = silent_.find(b);
  return first != silent_.end() && second != silent_.end() && first->second.retry_at < second->second.retry_at;
}

void UnitBackoff::answered(int unit) {
  // The cause, perhaps power, may have brought back other units too: ask them at once.
  if (silent_.erase(unit) > 0) paid_until_ = Time{};
}

void UnitBackoff::silent(int unit, Time now, Duration first_pause, Duration waited) {
  Silence& silence = silent_[unit];
  if (silence.times > 0) paid_until_ = std::max(paid_until_, now) + kProbeShare * waited;  // a probe
  const Duration pause = silence.times == 0 ? first_pause : silence.times == 1 ? kSecondPause : kLongestPause;
  silence.retry_at = now + std::max(pause, first_pause);
  ++silence.times;
}

void UnitBackoff::forget() {
  silent_.clear();
  paid_until_ = Time{};
}

UnitSetup::UnitSetup(const std::map<int, UnitRules>& rules) {
  for (const auto& [unit, rule] : rules) {
    if (!rule.map || rule.map->setup.empty()) continue;
    for (const SetupWrite& write : rule.map->setup) {
      const MappedRegister& reg = rule.map->registers[write.index];
      units_[unit].writes.push_back(
          {reg.address, words_of(write.value_raw, reg.format), reg.table == RegisterTable::coil, reg.name});
    }
  }
}

const UnitSetup::Write* UnitSetup::next(int unit) const {
  const auto found = units_.find(unit);
  if (found == units_.end() || found->second.done >= found->second.writes.size()) return nullptr;
  return &found->second.writes[found->second.done];
}

void UnitSetup::restart(int unit) {
  if (const auto found = units_.find(unit); found != units_.end()) found->second.done = 0;
}

void UnitSetup::restart_all() {
  for (auto& [unit, setup] : units_) setup.done = 0;
}

}  // namespace luxrig::modbus
