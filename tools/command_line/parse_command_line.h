#pragma once
/// Parsing, and the mend of what was mistyped.

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>

namespace luxrig {

/// To be called before options are added: help then tells every default.
void begin_command_line(CLI::App& app);

/// Parses, which runs the callbacks; answers --help and --version. The exit code when the program is to end: 0 when it
/// was asked for help, 2 with a line on standard error when the line was wrong.
[[nodiscard]] std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

/// What is wrong with the words after the program's name, and what would mend it: "luxrig: there is no command \"rnu\":
/// did you mean \"run\"?"; empty when every name is known.
[[nodiscard]] std::string mend_of(const CLI::App& app, std::span<const std::string> words);

}  // namespace luxrig
