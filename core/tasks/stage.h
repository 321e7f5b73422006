#pragma once
/// A part of a task that may take long: reports its progress to the watcher, and ends after a timeout.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "core/run.h"

namespace luxrig {

/// The only time limit of core. Its thread ends with the stage.
class Stage {
 public:
  /// watch     its stop ends the stage with the best so far; use Watch::without_stop() if a stop must not end it
  /// first     its first activity
  /// seconds   after which the computation is asked to end; none = never
  Stage(const Watch& watch, std::string name, std::string first, std::optional<double> seconds = {});
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Requested after the timeout, or by a stop from outside.
  [[nodiscard]] std::stop_token stop() const { return source_.get_token(); }
  [[nodiscard]] bool time_is_up() const;
  void say(std::string what) const;

 private:
  Tell tell_;
  std::string name_;
  bool can_be_taken_;
  std::stop_source source_;
  std::stop_callback<std::function<void()>> asked_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false, time_is_up_ = false;
  std::thread timer_;  ///< last: it uses all members above
};

}  // namespace luxrig
