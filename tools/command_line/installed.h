#pragma once
/// Files that came with the programs: in `share/luxrig` beside them, in a build as well as installed.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace luxrig {

/// "<prefix>/share/luxrig" for a program in "<prefix>/bin".
[[nodiscard]] std::filesystem::path shared_folder();

/// Names of the rigs that came with the program, sorted.
[[nodiscard]] std::vector<std::string> shipped_rigs();

/// The option RIG: a rig file, a folder with one, or the name of a rig that came with the program ("gallery").
CLI::Option* add_rig_option(CLI::App& app, std::filesystem::path& rig);

}  // namespace luxrig
