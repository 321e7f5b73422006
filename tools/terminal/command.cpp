#include "tools/terminal/command.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

namespace luxrig {

namespace {

/// Not fmt::print, which throws if the disk of a log is full or a pipe has no reader.
void tell(const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
  (void)std::fflush(stderr);
}

}  // namespace

int report(const std::vector<Problem>& problems) {
  for (const Problem& problem : problems) tell(problem.text() + "\n");
  return kExitBadInput;
}

int report(const Fault& fault) {
  tell(fmt::format("luxrig: {}{}{}: {}\n", name_of(fault.cause), fault.device.empty() ? "" : " at ", fault.device,
                   fault.detail));
  return kExitFailed;
}

Progress progress_line(std::string what) {
  using Steady = std::chrono::steady_clock;
  struct Line {
    std::string what;
    Steady::time_point start = Steady::now();
    bool terminal = isatty(STDERR_FILENO) != 0;
    int last_percent = -1;
    bool shown = false;
  };
  auto line = std::make_shared<Line>();
  line->what = std::move(what);
  return [line](double done) {
    const int percent = static_cast<int>(100 * done);
    const double seconds = std::chrono::duration<double>(Steady::now() - line->start).count();
    const bool last = done >= 1;
    if (seconds < 0.5 || (percent == line->last_percent && !last)) return;
    if (!line->terminal && !last && percent / 25 == line->last_percent / 25) return;
    line->last_percent = percent;
    line->shown = true;
    tell(fmt::format("{}{} {:3d} %  {:.1f} s{}", line->terminal ? "\r" : "", line->what, percent, seconds,
                     line->terminal && !last ? "" : "\n"));
  };
}

std::stop_token stop_on_signals() {
  // A thread waits for the signals, so that no handler has to be async-signal-safe.
  static const std::stop_source source = [] {
    std::stop_source made;
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::thread([made, set]() mutable {
      int signal = 0;
      sigwait(&set, &signal);
      made.request_stop();
      // A second signal ends the process in the ordinary way.
      pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
      sigwait(&set, &signal);
      _exit(128 + signal);
    }).detach();
    return made;
  }();
  return source.get_token();
}

void keep_signal(int signal) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

std::jthread on_signal(int signal, std::function<void()> run) {
  return std::jthread([signal, run = std::move(run)](const std::stop_token& stop) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, signal);
    const timespec look{0, 100'000'000};
    while (!stop.stop_requested())
      if (sigtimedwait(&set, nullptr, &look) == signal) run();
  });
}

}  // namespace luxrig
