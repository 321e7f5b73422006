#pragma once
/// A stop token that stops after a time.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

namespace luxrig {

class StopAfter {
 public:
  /// none = never
  explicit StopAfter(std::optional<double> seconds) {
    if (!seconds) return;
    waiting_ = std::jthread([this, seconds = *seconds](const std::stop_token& ended) {
      std::unique_lock lock(mutex_);
      if (!never_.wait_for(lock, ended, std::chrono::duration<double>(seconds), [] { return false; }) &&
          !ended.stop_requested())
        source_.request_stop();
    });
  }
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::mutex mutex_;
  std::condition_variable_any never_;
  std::jthread waiting_;  // last: it uses the other members
};

}  // namespace luxrig
