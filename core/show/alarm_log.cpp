#include "core/show/alarm_log.h"

#include <algorithm>
#include <string>

namespace luxrig {

bool is_same_alarm(const Alarm& a, const Alarm& b) {
  if (a.severe != b.severe || a.device != b.device || a.since != b.since) return false;
  const auto words = [](std::string text) {
    bool in_name = false;  // "spot-1" and "spot-2" are two
    std::erase_if(text, [&](char c) {
      if (c == '"') in_name = !in_name;
      return !in_name && ((c >= '0' && c <= '9') || c == '.');
    });
    return text;
  };
  return a.text == b.text || words(a.text) == words(b.text);
}

std::vector<Alarm> AlarmLog::to_say(std::span<const Alarm> alarms, Time now) {
  std::erase_if(said_, [&](const Said& said) { return now - said.at >= kAgain; });
  std::vector<Alarm> fresh;
  for (const Alarm& alarm : alarms) {
    const bool known = std::any_of(said_.begin(), said_.end(), [&](const Said& said) {
      Alarm before = said.alarm;
      if (now - said.at < kRest) before.since = alarm.since;
      return is_same_alarm(before, alarm);
    });
    if (known) continue;
    said_.push_back({alarm, now});
    fresh.push_back(alarm);
  }
  return fresh;
}

}  // namespace luxrig
