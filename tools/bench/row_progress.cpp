#include "tools/bench/row_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace luxrig {
namespace {

using Steady = std::chrono::steady_clock;

struct Line {
  Steady::time_point start = Steady::now(), said = start;
  bool terminal = isatty(STDERR_FILENO) != 0;
  int rows = 0;
  bool shown = false;
};

Line& line() {
  static Line of_process;
  return of_process;
}

constexpr double kSecondsBetweenLines = 10;
constexpr const char* kClearLine = "\r\033[K";

}  // namespace

void say_row_made(std::string_view case_name, std::string_view method) {
  Line& at = line();
  ++at.rows;
  const auto now = Steady::now();
  const auto seconds = [&](Steady::time_point from) { return std::chrono::duration<double>(now - from).count(); };
  if (!at.terminal && seconds(at.said) < kSecondsBetweenLines) return;
  fmt::print(stderr, "{}{:.0f} s, {} rows, the last {} by {}{}", at.terminal ? kClearLine : "", seconds(at.start),
             at.rows, case_name, method, at.terminal ? "" : "\n");
  std::fflush(stderr);
  at.said = now;
  at.shown = true;
}

void end_row_progress() {
  if (line().shown && line().terminal) fmt::print(stderr, "{}", kClearLine);
  line() = Line();
}

}  // namespace luxrig
