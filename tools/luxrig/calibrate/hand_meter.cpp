#include "tools/luxrig/calibrate/hand_meter.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "tools/process/files.h"

namespace luxrig {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoll_ms = 200;
constexpr std::size_t kLongestLine = 200;

}  // namespace

HandMeter::Line HandMeter::next_line(std::string& line) {
  for (;;) {
    if (const auto end = typed_.find('\n'); end != std::string::npos) {
      line = typed_.substr(0, end);
      typed_.erase(0, end + 1);
      return Line::whole;
    }
    if (ended_ || typed_.size() > kLongestLine) {
      line = std::exchange(typed_, {});
      return line.empty() ? Line::end : Line::whole;
    }
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, kPoll_ms) <= 0) return Line::none_yet;
    char text[256];
    const ssize_t count = ::read(STDIN_FILENO, text, sizeof text);
    if (count > 0)
      typed_.append(text, static_cast<std::size_t>(count));
    else
      ended_ = true;
  }
}

Result<HandAnswer> HandMeter::ask(const std::string& what, std::chrono::seconds period,
                                  const std::function<Result<void>()>& waiting, const std::stop_token& stop) {
  auto told = Clock::now();
  const auto prompt = [&] {
    fmt::print("  {}: ", what);
    std::fflush(stdout);
  };
  prompt();
  for (;;) {
    if (stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
    if (Clock::now() - told >= period) {
      told = Clock::now();
      if (auto ok = waiting(); !ok) return tl::unexpected(ok.error());
    }
    std::string line;
    switch (next_line(line)) {
      case Line::none_yet:
        continue;
      case Line::end:
        return HandAnswer{HandAnswer::What::done};
      case Line::whole:
        break;
    }
    auto answer = hand_answer(line);
    if (answer && answer->what == HandAnswer::What::from_file && file_) {
      const auto text = read_file(*file_);
      const auto lux = text ? last_reading(*text) : std::nullopt;
      if (lux) {
        fmt::print("    {:.4g} lx from {}\n", *lux, file_->string());
        return HandAnswer{HandAnswer::What::reading, *lux};
      }
      fmt::print("    the last line of {} holds no reading; type it\n", file_->string());
      answer = std::nullopt;
    } else if (answer && answer->what != HandAnswer::What::from_file) {
      return *answer;
    } else {
      fmt::print(
          "    type the reading in lux, such as 182 or 182.5; s skips this lamp, n goes to another place, q ends\n");
    }
    prompt();
  }
}

}  // namespace luxrig
