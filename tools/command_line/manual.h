#pragma once
/// Man pages, from the options that a program declares.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace luxrig {

struct ManPage {
  std::string name;  ///< "luxrig-check"; the file is name + ".1"
  std::string text;  ///< section 1, in man(7)
};
/// The program's page, then one for each of its commands. A command without an option for help is another program.
[[nodiscard]] std::vector<ManPage> man_pages(const CLI::App& app);

}  // namespace luxrig
