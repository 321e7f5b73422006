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

/// A word that help does not tell of, and what whoever types it is told: "is refused, as …: use …".
struct RefusedWord {
  std::string word, told;
};

/// Takes these words only. Its description, which help and completion read, is "one of auto, direct or path".
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words, std::vector<RefusedWord> refused = {});

/// The words of an option that takes some only; none for any other.
[[nodiscard]] std::vector<std::string> words_to_choose(const CLI::Option& option);

/// Sets `value` (an enum, or an optional one) by a word. The word of the value that it has at this moment is the
/// default.
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
