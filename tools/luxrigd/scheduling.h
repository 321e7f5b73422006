#pragma once
/// How threads share the processor: output first, solvers last.

#include <optional>
#include <thread>

namespace luxrig {

/// Puts the calling thread under SCHED_FIFO. False if not allowed (no CAP_SYS_NICE, no rtprio limit).
bool make_realtime(int priority);

/// Whether make_realtime would be allowed, tried on a thread of its own.
bool realtime_allowed();

/// Locks the process's memory in RAM, so that the output thread never waits for a page. False if not allowed.
bool lock_memory();

/// Low priority (nice 15) for the calling thread and the threads it starts, so that others run first.
void make_background();

/// Result of work on a thread of low priority. Returns when it is done.
template <class Work>
auto in_background(const Work& work) {
  std::optional<decltype(work())> result;
  std::thread([&] {
    make_background();
    result.emplace(work());
  }).join();
  return std::move(*result);
}

}  // namespace luxrig
