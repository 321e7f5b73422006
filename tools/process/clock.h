#pragma once
/// The one real clock: CLOCK_MONOTONIC as controller time.

#include <time.h>

#include <atomic>
#include <cerrno>

#include "core/time.h"

namespace luxrig {

/// A time that a test steps, used in place of the clock; null = the clock.
inline std::atomic<const std::atomic<Time>*> stepped_time{nullptr};

[[nodiscard]] inline Time now() {
  if (const auto* stepped = stepped_time.load(std::memory_order_acquire)) return stepped->load();
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Time(std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec));
}

/// With stepped time: by how much the wall clock is ahead of it [s].
inline std::atomic<double> stepped_wall_ahead_s{0};

/// Wall-clock time [s since 1970], for what is saved. With stepped time: that, since its own beginning.
[[nodiscard]] inline double unix_now_s() {
  if (const auto* stepped = stepped_time.load(std::memory_order_acquire))
    return to_seconds(stepped->load().time_since_epoch()) + stepped_wall_ahead_s;
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

inline void sleep_until(Time wake) {
  const auto since_epoch = wake.time_since_epoch().count();
  timespec t{};
  t.tv_sec = since_epoch / 1'000'000'000;
  t.tv_nsec = since_epoch % 1'000'000'000;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace luxrig
