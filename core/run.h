#pragma once
/// How a long computation is run: its seed and threads, and who watches and stops it.

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

namespace luxrig {

/// Called now and then from the calling thread with the share done, 0…1, and never after return.
using Progress = std::function<void(double done)>;

struct Doing {
  std::string stage;  ///< its name
  std::string what;   ///< what it does now, or the best it has
  bool ended = false;
  bool can_be_taken = false;  ///< a stop ends it with the best it has; else a stop cancels it
};

/// Called at the start of a stage, whenever there is news, and at its end, from any thread of the computation. A stage
/// may begin inside another, and ends before it.
using Tell = std::function<void(const Doing&)>;

struct Watch {
  std::stop_token stop;  ///< when requested, the computation returns Cause::cancelled or the best it has soon
  Progress progress;     ///< may be empty
  Tell tell = {};        ///< may be empty

  /// For work that a stop must not end: it still tells its news.
  [[nodiscard]] Watch without_stop() const { return {{}, {}, tell}; }
};

/// What the options of every long computation begin with.
struct Run {
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0 = one per core; no result depends on it
  Watch watch;

  /// To hand down: `part.run() = options.of_part()`.
  [[nodiscard]] Run& run() { return *this; }
  /// The same for a part of the computation, which does not know the share done of the whole.
  [[nodiscard]] Run of_part() const { return {seed, threads, {watch.stop, {}, watch.tell}}; }
};

}  // namespace luxrig
