#include "tools/bench/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <optional>
#include <thread>

#include "tools/command_line/version.h"

namespace luxrig {
namespace {

constexpr std::string_view kHead =
    "| case | method | error | seconds | target | verdict | measured | command |\n|---|---|---|---|---|---|---|---|\n";

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with("model name") && colon + 2 < line.size()) return line.substr(colon + 2);
  }
  return "unknown processor";
}

/// A bar would end the cell.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string error_text(double error) { return std::isfinite(error) ? fmt::format("{:.3g}", error) : "–"; }

std::string target_text(const BenchRow& row) {
  std::string text;
  if (row.target_error) text = fmt::format("{:.3g}", *row.target_error);
  if (row.target_seconds) text += fmt::format("{}{:.3g} s", text.empty() ? "" : " in ", *row.target_seconds);
  return text.empty() ? "none" : text;
}

std::string key_of(const BenchRow& row) { return fmt::format("| {} | {} |", cell(row.case_name), cell(row.method)); }

std::string line_of(const BenchRow& row, std::string_view command, const Provenance& by) {
  const auto met = row.met();
  return fmt::format("{} {} | {:.3g} | {} | {} | {}, {}, {} | `{}` |\n", key_of(row), error_text(row.error),
                     row.seconds, target_text(row),
                     !met   ? "no target"
                     : *met ? "good"
                            : "short",
                     by.version, by.date, cell(by.machine), cell(command));
}

}  // namespace

Provenance provenance() {
  return {kVersion, fmt::format("{} × {}", std::thread::hardware_concurrency(), processor_name()),
          fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))};
}

std::string with_rows(std::string_view text, std::string_view suite, std::string_view command,
                      const std::vector<BenchRow>& rows, const Provenance& by) {
  const std::string heading = fmt::format("### {}\n\n{}", suite, kHead);
  std::string out(text);
  if (!out.empty() && !out.ends_with('\n')) out += '\n';
  std::size_t begin = out.find(heading);
  if (begin == std::string::npos) {
    if (!out.empty()) out += '\n';
    begin = out.size();
    out += heading;
  }
  begin += heading.size();
  std::size_t end = begin;
  while (end < out.size() && out[end] == '|') end = std::min(out.find('\n', end), out.size() - 1) + 1;
  std::string table = out.substr(begin, end - begin);
  for (const BenchRow& row : rows) {
    const std::string line = line_of(row, command, by);
    const std::size_t before = table.find("\n" + key_of(row));
    const std::optional<std::size_t> at = table.starts_with(key_of(row)) ? std::optional<std::size_t>(0)
                                          : before == std::string::npos  ? std::nullopt
                                                                         : std::optional(before + 1);
    if (at)
      table.replace(*at, table.find('\n', *at) + 1 - *at, line);
    else
      table += line;
  }
  return out.replace(begin, end - begin, table);
}

}  // namespace luxrig
