#pragma once
/// The one real clock: CLOCK_MONOTONIC as controller time.

#include <time.h>

#include <cerrno>

#include "core/time.h"

namespace luxrig {

[[nodiscard]] inline Time now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Time(std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec));
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
