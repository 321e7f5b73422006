#pragma once
/// Keeps a universe's packets at or below the rate of a DMX line, however often write() is called.

#include <algorithm>
#include <optional>

#include "drivers/dmx/dmx_patch.h"

namespace luxrig {

/// A 44 Hz caller is sometimes slightly early. Refusing those calls would halve its rate, so a packet may go up to half
/// a period early. The schedule itself never runs faster than its period.
class SendRate {
 public:
  explicit SendRate(Duration period = kDmxShortestPeriod) : period_(period) {}

  /// Whether a packet may go now.
  [[nodiscard]] bool may_go(Time now) const { return !next_due_ || now + period_ / 2 >= *next_due_; }
  /// True if a packet may go now; it then counts as sent.
  [[nodiscard]] bool take(Time now) {
    if (!may_go(now)) return false;
    next_due_ = std::max(next_due_.value_or(now), now) + period_;
    return true;
  }

 private:
  Duration period_{};
  std::optional<Time> next_due_;
};

}  // namespace luxrig
