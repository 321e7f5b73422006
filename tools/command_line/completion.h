#pragma once
/// Completion in a shell. The shell asks the program itself for the words that could complete the one being typed
/// (`PROGRAM --complete WORD...`, the last one unfinished). So every shell offers the same words, and exactly those
/// that this program accepts.

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace luxrig {

enum class Shell { bash, zsh, fish };
[[nodiscard]] std::vector<std::pair<std::string, Shell>> shells();

/// For an option's check(): states the kind of its values, and accepts any.
[[nodiscard]] CLI::Validator offers_files();
[[nodiscard]] CLI::Validator offers_folders();
/// The name of a validator for an option that takes a rig: files, or a rig that came with the program.
inline constexpr const char* kOffersRigs = "rigs";

struct Offer {
  struct Word {
    std::string text, told;
  };
  enum class Places { none, files, folders };
  std::vector<Word> words;  ///< all words; the shell takes those that fit the beginning
  Places places = Places::none;
};
/// Completes the last of the words after the program's name.
[[nodiscard]] Offer offer_for(CLI::App& app, std::span<const std::string> words);
/// For the shells: a line "files", "folders" or "none", then lines "WORD<tab>description".
[[nodiscard]] std::string offer_text(const Offer& offer);

/// The script that a shell has to read once.
[[nodiscard]] std::string completion_script(const std::string& program, Shell shell);

}  // namespace luxrig
