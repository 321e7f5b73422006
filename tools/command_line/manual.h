#pragma once
/// Man page and completion, from what a program declares of its options.

#include <CLI/CLI.hpp>
#include <string>

namespace luxrig {

/// Section 1, in man(7).
[[nodiscard]] std::string man_page(const CLI::App& app);
/// For bash: commands, options, words to choose from, else files.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

}  // namespace luxrig
