#include "tools/luxrig/search_watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace luxrig {
namespace {

using Steady = std::chrono::steady_clock;

constexpr double kSilent_s = 2, kEvery_s = 10;  // not on a terminal, where a line each is kept

}  // namespace

SearchWatch::SearchWatch(std::string name, std::string first, std::optional<double> seconds, std::stop_token stop,
                         std::string interrupt)
    : name_(std::move(name)),
      interrupt_(std::move(interrupt)),
      seconds_(seconds),
      asked_(std::move(stop)),
      terminal_(isatty(STDERR_FILENO) != 0),
      text_(std::move(first)),
      thread_([this] { run(); }) {}

SearchWatch::~SearchWatch() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  thread_.join();
  if (said_ && terminal_) fmt::print(stderr, "\n");
}

void SearchWatch::say(std::string text) {
  const std::lock_guard lock(mutex_);
  text_ = std::move(text);
}

void SearchWatch::run() {
  const Steady::time_point start = Steady::now();
  std::unique_lock lock(mutex_);
  double said_s = 0;
  while (!changed_.wait_for(lock, std::chrono::milliseconds(100), [&] { return ended_; })) {
    const double now_s = std::chrono::duration<double>(Steady::now() - start).count();
    if (asked_.stop_requested() || (seconds_ && now_s >= *seconds_)) source_.request_stop();
    if (now_s < kSilent_s || (said_ && now_s - said_s < (terminal_ ? 0.5 : kEvery_s))) continue;
    said_s = now_s;
    said_ = true;
    fmt::print(stderr, "{}{}: {:.0f} s, {}{}", terminal_ ? "\r\x1b[K" : "", name_, now_s, text_,
               terminal_ ? " (Ctrl-C: " + interrupt_ + ")" : "\n");
    std::fflush(stderr);
  }
}

}  // namespace luxrig
