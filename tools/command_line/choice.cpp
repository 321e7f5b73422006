#include "tools/command_line/choice.h"

#include "core/rig/nearest.h"

namespace luxrig {

std::string in_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

CLI::Validator one_of(std::vector<std::string> words, std::vector<RefusedWord> refused) {
  std::string description = "one of " + in_words(words);
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
