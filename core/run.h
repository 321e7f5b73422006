#pragma once
/// How a long computation runs: its seed, its threads, and how it is watched and stopped.

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

namespace luxrig {

/// Called now and then from the calling thread with the share done, 0…1. Never called after return.
using Progress = std::function<void(double done)>;

struct Doing {
  std::string stage;  ///< name
  std::string what;   ///< its current work, or the best result so far
  bool ended = false;
  bool can_be_taken = false;  ///< a stop ends it with its best result so far; else a stop cancels it
};

/// Called when a stage starts, has news, or ends, from any thread of the computation. A stage may start inside another
/// and ends before it.
using Tell = std::function<void(const Doing&)>;

struct Watch {
  std::stop_token stop;  ///< on request, the computation soon returns Cause::cancelled or its best result so far
  Progress progress;     ///< may be empty
  Tell tell = {};        ///< may be empty

  /// For work that must finish even after a stop. It still reports its news.
  [[nodiscard]] Watch without_stop() const { return {{}, {}, tell}; }
};

/// Common options of every long computation.
struct Run {
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0 = one per core; results do not depend on it
  Watch watch;

  /// For handing down: `part.run() = options.of_part()`.
  [[nodiscard]] Run& run() { return *this; }
  /// The same options for a part of the computation. Without `progress`, since a part does not know the share done of
  /// the whole.
  [[nodiscard]] Run of_part() const { return {seed, threads, {watch.stop, {}, watch.tell}}; }
};

}  // namespace luxrig
