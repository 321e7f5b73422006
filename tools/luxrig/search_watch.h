#pragma once
/// Watches a search: a person sees how far it is from two seconds on, and what asks for its end reaches it.

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
  /// name      of the task, before each line
  /// seconds   after which the search is asked to end
  /// stop      asks it to end, too
  /// interrupt what Ctrl-C does, as a person at a terminal is told
  SearchWatch(std::string name, std::string first, std::optional<double> seconds, std::stop_token stop,
              std::string interrupt = "take this");
  ~SearchWatch();
  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;

  [[nodiscard]] std::stop_token stop() const { return source_.get_token(); }
  /// What it does now, or the best it has.
  void say(std::string text);

 private:
  void run();

  std::string name_, interrupt_;
  std::optional<double> seconds_;
  std::stop_token asked_;
  std::stop_source source_;
  bool terminal_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string text_;
  bool ended_ = false, said_ = false;
  std::thread thread_;  ///< last: it uses all of these
};

}  // namespace luxrig
