#include "tools/terminal/terminal_watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace luxrig {
namespace {

constexpr double kSilent_s = 1.5, kEvery_s = 10, kEveryOnTerminal_s = 0.5;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Not fmt::print, which throws if the disk of a log is full or a pipe has no reader.
void to_standard_error(const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
  (void)std::fflush(stderr);
}

}  // namespace

TerminalWatch::TerminalWatch(std::function<void(std::string)> sink)
    : terminal_(isatty(STDERR_FILENO) != 0),
      sink_(sink ? std::move(sink) : to_standard_error),
      thread_([this] { run(); }) {}

TerminalWatch::~TerminalWatch() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void TerminalWatch::told(const Doing& doing) {
  const std::lock_guard lock(mutex_);
  const auto at =
      std::find_if(stages_.rbegin(), stages_.rend(), [&](const Line& line) { return line.doing.stage == doing.stage; });
  if (doing.ended) {
    if (at == stages_.rend()) return;
    if (at->said && terminal_) sink_("\n");
    stages_.erase(std::next(at).base());
  } else if (at == stages_.rend()) {
    stages_.push_back({doing, now_s()});
  } else {
    at->doing.what = doing.what;
  }
}

void TerminalWatch::run() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, std::chrono::milliseconds(100), [&] { return ended_; })) {
    if (stages_.empty()) continue;
    Line& line = stages_.back();
    const double now = now_s(), spent_s = now - line.start_s;
    if (spent_s < kSilent_s || (line.said && now - line.said_s < (terminal_ ? kEveryOnTerminal_s : kEvery_s))) continue;
    line.said_s = now;
    line.said = true;
    sink_(fmt::format("{}{}: {:.0f} s, {}{}", terminal_ ? "\r\x1b[K" : "", line.doing.stage, spent_s, line.doing.what,
                      !terminal_                ? "\n"
                      : line.doing.can_be_taken ? " (Ctrl-C: take this)"
                                                : ""));
  }
}

}  // namespace luxrig
