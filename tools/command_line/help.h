#pragma once
/// Help in plain words.

#include <CLI/CLI.hpp>
#include <string>

namespace luxrig {

/// Values of an option, in words: "1 to 64", "above 0", "one of auto or path"; empty if any value of its kind is
/// accepted.
[[nodiscard]] std::string values_in_words(const CLI::Option& option);
/// Its description, its values, its default.
[[nodiscard]] std::string option_in_words(const CLI::Option& option);
/// "-o, --output FILE", "--json", "RIG".
[[nodiscard]] std::string option_names(const CLI::Option& option);

/// For an app and all its subcommands.
void tell_help_in_words(CLI::App& app);

}  // namespace luxrig
