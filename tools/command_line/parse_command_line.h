#pragma once
/// Parsing, and how to mend mistyped words.

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>

namespace luxrig {

/// Call before options are added: help then states every default.
void begin_command_line(CLI::App& app);

/// Parses, which runs the callbacks; answers --help and --version. Returns the exit code if the program is to end: 0
/// after help, 2 after a wrong line, with a message on standard error.
[[nodiscard]] std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

/// The problem with the words after the program's name, and how to mend it: "luxrig: there is no command \"rnu\": did
/// you mean \"run\"?"; empty if every name is known.
[[nodiscard]] std::string mend_of(const CLI::App& app, std::span<const std::string> words);

}  // namespace luxrig
