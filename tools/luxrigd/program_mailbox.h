#pragma once
/// Hands the newest OutputProgram from the control thread to the output threads. The reader never waits: while the
/// writer is copying, it keeps its program for one more cycle.

#include <atomic>
#include <mutex>

#include "core/output/output_program.h"

namespace luxrig {

class ProgramMailbox {
 public:
  void put(const OutputProgram& program) {
    const std::lock_guard lock(mutex_);
    program_ = program;
    revision_.store(program.revision, std::memory_order_release);
  }

  /// Copies the newest program into `mine` if it is newer. After the first time the sizes agree and nothing is
  /// allocated.
  void take(OutputProgram& mine) {
    if (revision_.load(std::memory_order_acquire) == mine.revision) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) mine = program_;
  }

 private:
  std::mutex mutex_;
  OutputProgram program_;
  std::atomic<std::uint64_t> revision_{0};
};

}  // namespace luxrig
