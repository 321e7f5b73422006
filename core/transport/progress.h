#pragma once
/// Progress of multi-threaded work, reported from the calling thread.

#include <algorithm>
#include <atomic>
#include <thread>

#include "core/run.h"

namespace luxrig {

/// One stretch of work, from share `begin` to share `end`, in `parts` equal parts. Reports rise, each by at least 1 %.
class CallingThreadProgress {
 public:
  CallingThreadProgress(const Watch& watch, double begin, double end, std::size_t parts)
      : watch_(watch), caller_(std::this_thread::get_id()), begin_(begin), end_(end), parts_(parts), last_(begin) {}

  /// From any thread.
  void one_done() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (!watch_.progress || std::this_thread::get_id() != caller_) return;
    const double share = begin_ + (end_ - begin_) * static_cast<double>(done) / static_cast<double>(parts_);
    if (share < last_ + 0.01) return;
    last_ = share;
    watch_.progress(std::min(share, end_));
  }

  /// From the calling thread.
  void report_end() {
    if (watch_.progress) watch_.progress(end_);
  }

 private:
  const Watch& watch_;
  std::thread::id caller_;
  double begin_, end_;
  std::size_t parts_;
  double last_;  // of the calling thread
  std::atomic<std::size_t> done_{0};
};

}  // namespace luxrig
