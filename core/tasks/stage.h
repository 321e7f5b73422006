#pragma once
/// A part of a task that may take long: whoever watches is told what it does, and time that is up ends it.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace luxrig {

struct Doing {
  std::string task;  ///< its name
  std::string what;  ///< what it does now, or the best it has
  bool ended = false;
  bool can_be_taken = false;  ///< a stop ends it with the best it has; else a stop cancels it
};

/// Called at the start of a stage, whenever there is news, and at its end, from any thread of the computation. A stage
/// may begin inside another, and ends before it.
using Tell = std::function<void(const Doing&)>;

/// The only time limit of core. Its thread ends with the stage.
class Stage {
 public:
  /// tell      may be empty
  /// seconds   after which the computation is asked to end; none: never
  /// stop      ends it with the best it has; none: a stop is not the stage's
  Stage(Tell tell, std::string task, std::string first, std::optional<double> seconds, const std::stop_token& stop);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Requested when the seconds have passed, or by whoever asked from outside.
  [[nodiscard]] std::stop_token stop() const { return source_.get_token(); }
  [[nodiscard]] bool time_is_up() const;
  void say(std::string what) const;

 private:
  Tell tell_;
  std::string task_;
  bool can_be_taken_;
  std::stop_source source_;
  std::stop_callback<std::function<void()>> asked_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false, time_is_up_ = false;
  std::thread timer_;  ///< last: it uses all of these
};

}  // namespace luxrig
