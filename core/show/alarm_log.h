#pragma once
/// Which alarms are worth a line, so that a failure that lasts an hour fills no log.

#include <span>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {

/// Of one cause, with the same names in quotes, and in the same words but for figures, which may grow.
[[nodiscard]] bool is_same_alarm(const Alarm& a, const Alarm& b);

class AlarmLog {
 public:
  static constexpr Duration kAgain = std::chrono::minutes(10);  ///< it lasts: said again
  static constexpr Duration kRest = std::chrono::minutes(1);    ///< it comes and goes: said once in this

  /// Those to say now: each when it begins, and again by the two rules above.
  [[nodiscard]] std::vector<Alarm> to_say(std::span<const Alarm> alarms, Time now);

 private:
  struct Said {
    Alarm alarm;
    Time at{};
  };
  std::vector<Said> said_;
};

}  // namespace luxrig
