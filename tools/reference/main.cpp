// luxrig-reference: copies rigs/REFERENCE.md from standard input to standard output, with each table made from the keys
// of the schema and the options of the drivers. A table stands below the heading of its section or driver and begins
// with the line kHead.
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/schema.h"
#include "drivers/registry.h"

namespace luxrig {
namespace {

constexpr std::string_view kHead = "| key | type | unit | default | range | what |";
constexpr std::string_view kRule = "|---|---|---|---|---|---|";

std::string row(std::string_view key, std::string_view type, std::string_view unit, std::string_view fallback,
                std::string_view range, std::string_view summary) {
  const bool is_value = fallback != kRequired && fallback != kNone;
  const std::string_view mark = is_value ? "`" : "";
  return fmt::format("| `{}` | {} | {} | {}{}{} | {} | {} |\n", key, type, unit, mark, fallback, mark, range, summary);
}

/// The rows of each table, by the heading that it stands below.
std::map<std::string, std::string> tables() {
  std::map<std::string, std::string> rows;
  for (const SectionSpec& section : sections()) {
    std::string& table = rows[fmt::format("## `{}`", heading_of(section))];
    for (const KeySpec& key : keys_of(section.name))
      table += row(key.key, type_text(key.type), key.unit, key.fallback, range_text(key), key.summary);
  }
  for (const DriverEntry& driver : drivers()) {
    std::string& table = rows[fmt::format("### driver = \"{}\"", driver.name)];
    for (const OptionDoc& option : driver.options)
      table += row(option.key, option.type, option.unit, option.fallback, option.range, option.summary);
  }
  return rows;
}

/// The page with its tables made again. `wrong`: why that cannot be done.
std::string with_tables(std::istream& page, std::vector<std::string>& wrong) {
  std::map<std::string, std::string> missing = tables();
  std::string written, heading;
  bool in_table = false;
  for (std::string line; std::getline(page, line);) {
    if (in_table && line.starts_with('|')) continue;
    in_table = line == kHead;
    if (line.starts_with('#')) heading = line;
    written += line + '\n';
    if (!in_table) continue;
    const auto table = missing.find(heading);
    if (table == missing.end()) {
      wrong.push_back(fmt::format("a table of keys stands below \"{}\", which names no section or driver", heading));
      continue;
    }
    written += fmt::format("{}\n{}", kRule, table->second);
    missing.erase(table);
  }
  for (const auto& [wanted, rows] : missing)
    wrong.push_back(fmt::format("no line \"{}\" stands below a heading \"{}\"", kHead, wanted));
  return written;
}

}  // namespace
}  // namespace luxrig

int main() {
  std::vector<std::string> wrong;
  const std::string page = luxrig::with_tables(std::cin, wrong);
  for (const std::string& problem : wrong) fmt::print(stderr, "{}\n", problem);
  if (!wrong.empty()) return 1;
  std::cout << page << std::flush;
  return std::cout ? 0 : 1;
}
