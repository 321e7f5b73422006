#include "tools/bench/bench_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

std::string number(std::optional<double> value) {
  return value && std::isfinite(*value) ? fmt::format("{:.6g}", *value) : "";
}

std::vector<std::vector<std::string>> cells_of(const std::vector<BenchRow>& rows) {
  std::vector<std::vector<std::string>> cells = {
      {"case", "method", "error", "seconds", "target_error", "target_seconds", "met"}};
  if (!rows.empty())
    for (const auto& [name, value] : rows.front().further) cells.front().push_back(name);
  for (const BenchRow& row : rows) {
    const auto met = row.met();
    cells.push_back({row.case_name, row.method, number(row.error), number(row.seconds), number(row.target_error),
                     number(row.target_seconds), met ? (*met ? "1" : "0") : ""});
    for (const auto& [name, value] : row.further) cells.back().push_back(value);
  }
  return cells;
}

}  // namespace

std::optional<bool> BenchRow::met() const {
  if (!target_error && !target_seconds) return std::nullopt;
  return (!target_error || error <= *target_error) && (!target_seconds || seconds <= *target_seconds);
}

std::string csv_of(const std::vector<BenchRow>& rows) {
  std::string text;
  for (const auto& line : cells_of(rows)) text += fmt::format("{}\n", fmt::join(line, ","));
  return text;
}

std::string table_of(const std::vector<BenchRow>& rows) {
  const auto cells = cells_of(rows);
  std::vector<std::size_t> widths(cells.front().size(), 0);
  for (const auto& line : cells)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : cells) {
    for (std::size_t c = 0; c < line.size(); ++c) text += fmt::format("{:<{}}  ", line[c], widths[c]);
    text += '\n';
  }
  return text;
}

}  // namespace luxrig
