#pragma once
/// Options with a few words to choose from.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace luxrig {

/// "auto, direct or path".
[[nodiscard]] std::string in_words(const std::vector<std::string>& words);

/// A word that help leaves out, and the answer to a person who types it: "is refused, as …: use …".
struct RefusedWord {
  std::string word, told;
};

/// Accepts only these words. Its description, which help and completion read, is "one of auto, direct or path".
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words, std::vector<RefusedWord> refused = {});

/// The words that an option accepts; empty for an option with free values.
[[nodiscard]] std::vector<std::string> words_to_choose(const CLI::Option& option);

/// Sets `value` (an enum, or an optional one) by a word. The default is the word of its present value.
template <class Value, class Choice>
CLI::Option* add_choice(CLI::App& app, const std::string& names, Value& value, const std::string& description,
                        const std::vector<std::pair<std::string, Choice>>& choices,
                        std::vector<RefusedWord> refused = {}) {
  std::vector<std::string> words;
  for (const auto& [word, choice] : choices) words.push_back(word);
  auto* option = app.add_option_function<std::string>(
      names,
      [&value, choices](const std::string& word) {
        value =
            std::find_if(choices.begin(), choices.end(), [&](const auto& one) { return one.first == word; })->second;
      },
      description);
  option->check(one_of(words, std::move(refused)));
  for (const auto& [word, choice] : choices)
    if (value == choice) option->default_str(word);
  return option;
}

}  // namespace luxrig
