#include "tools/luxrig/calibrate/hand_meter.h"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "tools/process/files.h"

namespace luxrig {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoll_ms = 200;
constexpr auto kLookAtPage = std::chrono::milliseconds(500);
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

std::optional<HandAnswer> HandMeter::answer_of(const std::string& line) const {
  const auto answer = hand_answer(line);
  if (answer && answer->what != HandAnswer::What::from_file) return answer;
  if (!answer || !file_) {
    fmt::print(
        "    type the reading in lux, such as 182 or 182.5; s skips this lamp, n goes to another place, q ends\n");
    return std::nullopt;
  }
  const auto text = read_file(*file_);
  const auto lux = text ? last_reading(*text) : std::nullopt;
  if (!lux) {
    fmt::print("    the last line of {} holds no reading; type it\n", file_->string());
    return std::nullopt;
  }
  fmt::print("    {:.4g} lx from {}\n", *lux, file_->string());
  return HandAnswer{HandAnswer::What::reading, *lux};
}

HandAnswer HandMeter::from_page(const HandAnswer& answer) {
  // What was begun here was of this question, and is none of the next. In the background, that would stop the program.
  if (::isatty(STDIN_FILENO) == 1 && ::tcgetpgrp(STDIN_FILENO) == ::getpgrp()) {
    ::tcflush(STDIN_FILENO, TCIFLUSH);
    typed_.clear();
  }
  fmt::print("{}, from the page\n", words_of(answer));
  return answer;
}

void HandMeter::tell_why_no_page() {
  if (page_.why_not().empty() || told_why_no_page_) return;
  told_why_no_page_ = true;
  fmt::print("\n    (the page does not ask: {})\n", page_.why_not());
  std::fflush(stdout);
}

Result<HandAnswer> HandMeter::ask(const std::string& what, const HandQuestion& question, std::chrono::seconds period,
                                  const std::function<Result<void>()>& waiting, const std::stop_token& stop) {
  auto told = Clock::now();
  auto looked = told - kLookAtPage;
  const auto prompt = [&] {
    fmt::print("  {}: ", what);
    std::fflush(stdout);
  };
  page_.put(question);
  prompt();
  for (;;) {
    if (stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
    if (Clock::now() - told >= period) {
      told = Clock::now();
      if (auto ok = waiting(); !ok) return tl::unexpected(ok.error());
    }
    if (Clock::now() - looked >= kLookAtPage) {
      looked = Clock::now();
      if (const auto answer = page_.look()) return from_page(*answer);
      tell_why_no_page();
    }
    std::string line;
    const Line had = next_line(line);
    if (had == Line::none_yet) continue;
    const auto typed = had == Line::end ? HandAnswer{HandAnswer::What::done} : answer_of(line);
    if (typed) {
      const HandAnswer counts = page_.settle(*typed);
      return counts == *typed ? counts : from_page(counts);
    }
    prompt();
  }
}

}  // namespace luxrig
