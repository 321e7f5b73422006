#pragma once
/// Watches a long computation: a person sees how far it is before two seconds have passed, and what asks for its end
/// reaches it.

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace luxrig {

class SearchWatch {
 public:
  /// name      of the task, before each line; empty: says nothing
  /// seconds   after which the computation is asked to end
  /// stop      asks it to end, too
  SearchWatch(std::string name, std::string first, std::optional<double> seconds, std::stop_token stop);
  ~SearchWatch();
  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;

  [[nodiscard]] std::stop_token stop() const { return source_.get_token(); }
  /// Whether the seconds have passed.
  [[nodiscard]] bool time_is_up() const { return time_is_up_; }
  /// What it does now, or the best it has.
  void say(std::string text);

 private:
  void run();

  std::string name_;
  std::optional<double> seconds_;
  std::stop_token asked_;
  std::stop_source source_;
  bool terminal_;
  std::atomic<bool> time_is_up_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string text_;
  bool ended_ = false, said_ = false;
  std::thread thread_;  ///< last: it uses all of these
};

}  // namespace luxrig
