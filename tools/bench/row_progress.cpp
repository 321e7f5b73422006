#include "tools/bench/row_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>

namespace luxrig {
namespace {

using Steady = std::chrono::steady_clock;

struct Line {
  Steady::time_point start = Steady::now(), said = start;
  bool terminal = isatty(STDERR_FILENO) != 0;
  int rows = 0;
  bool shown = false;
  std::filesystem::path csv_file;
  bool csv_begun = false;
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

void keep_rows_in(const std::filesystem::path& csv_file) { line().csv_file = csv_file; }

void say_row_made(const BenchRow& row) {
  Line& at = line();
  if (!at.csv_file.empty()) {
    const std::string text = csv_of({row});
    const std::size_t header = text.find('\n') + 1;
    std::ofstream(at.csv_file, at.csv_begun ? std::ios::binary | std::ios::app : std::ios::binary)
        << (at.csv_begun ? text.substr(header) : text);  // a failed write is reported at the end
    at.csv_begun = true;
  }
  say_row_made(row.case_name, row.method);
}

void end_row_progress() {
  if (line().shown && line().terminal) fmt::print(stderr, "{}", kClearLine);
  line() = Line();
}

}  // namespace luxrig
