#pragma once
/// Whether to rely on a device, judged by its recent answers. One late answer is no failure, and one good answer no
/// recovery. A device that fails for longer than `patience` is lost. A lost device is good again after a run of good
/// answers; the more often it failed, the longer the run.

#include <algorithm>
#include <chrono>
#include <deque>

#include "core/time.h"

namespace luxrig {

class Trust {
 public:
  static constexpr Duration kRemembers = std::chrono::minutes(10);
  static constexpr Duration kFirstRow = std::chrono::seconds(1), kLongestRow = std::chrono::seconds(10);

  /// What was seen since the last call. failing: reported as faulted, or silent. missed: at least one answer did not
  /// come, or was garbled. answered: a good answer came; true where that is not known.
  void step(Time now, bool failing, bool missed, bool answered, Duration patience) {
    while (!falls_.empty() && now - falls_.front() > kRemembers) falls_.pop_front();
    if (failing || missed) {
      if (!bad_) falls_.push_back(now);
      if (falls_.size() > kMaxFalls) falls_.pop_front();
      bad_ = true;
      good_since_ = now;
    }
    if (!failing && (answered || failing_)) bad_ = false;  // no longer reported as faulted: it has answered
    if (!failing) {
      failing_ = false;
      if (lost_ && !bad_ && now - good_since_ >= row()) lost_ = false;
      return;
    }
    if (!failing_) failing_since_ = now;
    failing_ = true;
    if (!lost_ && now - failing_since_ >= patience) {
      lost_ = true;
      lost_since_ = now;
    }
  }

  [[nodiscard]] bool lost() const { return lost_; }
  [[nodiscard]] Time lost_since() const { return lost_since_; }
  /// How long it must answer well to be good again. A single failure is over with the first answer.
  [[nodiscard]] Duration row() const {
    if (falls_.size() <= 1) return {};
    return std::min(kLongestRow, kFirstRow * (1 << std::min<std::size_t>(falls_.size() - 2, 4)));
  }
  [[nodiscard]] std::size_t falls() const { return falls_.size(); }  ///< in the last ten minutes, at most kMaxFalls

 private:
  static constexpr std::size_t kMaxFalls = 100;
  std::deque<Time> falls_;  ///< when it turned from good to bad
  Time good_since_{}, failing_since_{}, lost_since_{};
  bool bad_ = false, failing_ = false, lost_ = false;
};

}  // namespace luxrig
