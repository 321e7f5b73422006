#include "tools/command_line/choice.h"

#include <sstream>
#include <string_view>

#include "core/text/nearest.h"

namespace luxrig {
namespace {

/// Prefix within an option's type name, where CLI11 puts a validator's description.
constexpr std::string_view kOneOf = ":one of ";

}  // namespace

std::string in_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

std::vector<std::string> words_to_choose(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto begin = type.find(kOneOf);
  if (begin == std::string::npos) return {};
  const auto after = begin + kOneOf.size();
  std::string told = type.substr(after, type.find(':', after) - after);
  if (const auto last = told.rfind(" or "); last != std::string::npos) told.replace(last, 4, ", ");
  std::vector<std::string> words;
  std::istringstream rest(told);
  for (std::string word; rest >> word;) words.push_back(word.substr(0, word.find(',')));
  return words;
}

CLI::Validator one_of(std::vector<std::string> words, std::vector<RefusedWord> refused) {
  std::string description = std::string(kOneOf.substr(1)) + in_words(words);
  return CLI::Validator(
      [words = std::move(words), refused = std::move(refused)](std::string& given) -> std::string {
        if (std::find(words.begin(), words.end(), given) != words.end()) return "";
        for (const RefusedWord& one : refused)
          if (one.word == given) return "\"" + given + "\" " + one.told;
        const std::vector<std::string_view> known(words.begin(), words.end());
        return "there is no \"" + given + "\": " + mend_for_unknown(given, known, "");
      },
      std::move(description));
}

}  // namespace luxrig
