#pragma once
/// Decides which alarms to log, so that a failure that lasts an hour does not fill the log.

#include <span>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {

/// True for the same device, severity and start, and the same text apart from figures outside quoted names.
[[nodiscard]] bool is_same_alarm(const Alarm& a, const Alarm& b);

class AlarmLog {
 public:
  static constexpr Duration kAgain = std::chrono::minutes(10);  ///< a lasting alarm is logged again
  static constexpr Duration kRest = std::chrono::minutes(1);    ///< an alarm that comes and goes is logged once in this

  /// The alarms to log now: each when it begins, then again by the two rules above.
  [[nodiscard]] std::vector<Alarm> to_say(std::span<const Alarm> alarms, Time now);

 private:
  struct Said {
    Alarm alarm;
    Time at{};
  };
  std::vector<Said> said_;
};

}  // namespace luxrig
