#include "core/show/alarm_log.h"

#include <algorithm>
#include <string_view>

namespace luxrig {

namespace {

/// A text without its figures, character by character; 0 = its end.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  [[nodiscard]] char next() {
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (c == '"') in_name_ = !in_name_;
      if (in_name_ || !((c >= '0' && c <= '9') || c == '.')) return c;
    }
    return 0;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  bool in_name_ = false;  ///< "spot-1" and "spot-2" are two
};

}  // namespace

bool is_same_alarm(const Alarm& a, const Alarm& b) {
  if (a.severe != b.severe || a.since != b.since || a.device != b.device) return false;
  if (a.text == b.text) return true;
  Words of_a(a.text), of_b(b.text);
  for (;;) {
    const char one = of_a.next();
    if (one != of_b.next()) return false;
    if (one == 0) return true;
  }
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
