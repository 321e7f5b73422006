#pragma once
/// Completion in a shell. The shell asks the program itself what may stand for the word that is being typed
/// (`PROGRAM --complete WORD...`, the last one unfinished), so that every shell offers the same, and what this very
/// program takes.

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace luxrig {

enum class Shell { bash, zsh, fish };
[[nodiscard]] std::vector<std::pair<std::string, Shell>> shells();

/// For an option's check(): says of what kind its values are, and takes any.
[[nodiscard]] CLI::Validator offers_files();
[[nodiscard]] CLI::Validator offers_folders();
/// The name of a validator whose option takes a rig: files, or one that came with the program.
inline constexpr const char* kOffersRigs = "rigs";

struct Offer {
  struct Word {
    std::string text, told;
  };
  enum class Places { none, files, folders };
  std::vector<Word> words;  ///< of any beginning: the shell takes those that fit
  Places places = Places::none;
};
/// For the last of the words after the program's name.
[[nodiscard]] Offer offer_for(CLI::App& app, std::span<const std::string> words);
/// As the shells read it: a line "files", "folders" or "none", then lines "WORD<tab>what it is".
[[nodiscard]] std::string offer_text(const Offer& offer);

/// What the shell has to read, once.
[[nodiscard]] std::string completion_script(const std::string& program, Shell shell);

}  // namespace luxrig
