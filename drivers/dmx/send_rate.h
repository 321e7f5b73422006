#pragma once
/// Keeps a universe's packets at or below the rate of a DMX line, however often write() is called.

#include <algorithm>
#include <optional>

#include "drivers/dmx/dmx_patch.h"

namespace luxrig {

/// A caller at 44 Hz is sometimes a little early. Refusing those calls would halve its rate, so a packet may go up to
/// half a period before it is due; the schedule itself never runs faster than kDmxShortestPeriod.
class SendRate {
 public:
  /// True when a packet may go now; it then counts as sent.
  [[nodiscard]] bool take(Time now) {
    if (next_due_ && now + kDmxShortestPeriod / 2 < *next_due_) return false;
    next_due_ = std::max(next_due_.value_or(now), now) + kDmxShortestPeriod;
    return true;
  }

 private:
  std::optional<Time> next_due_;
};

}  // namespace luxrig
