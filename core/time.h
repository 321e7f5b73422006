#pragma once
/// The controller's clock. It has no now(): only programs in tools/ read a real clock and pass the instant on. So all
/// code below also runs under a stepped clock.

#include <chrono>

namespace luxrig {

struct ControllerClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ControllerClock>;
  static constexpr bool is_steady = true;
};

using Time = ControllerClock::time_point;
using Duration = ControllerClock::duration;

/// Seconds as a Duration, rounded to the nearest nanosecond.
[[nodiscard]] inline Duration from_seconds(double seconds) {
  return Duration(static_cast<Duration::rep>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)));
}
[[nodiscard]] inline double to_seconds(Duration duration) { return static_cast<double>(duration.count()) * 1e-9; }

}  // namespace luxrig
