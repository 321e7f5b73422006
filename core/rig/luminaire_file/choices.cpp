#include "core/rig/luminaire_file/choices.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxChoicesNamed = 12;

std::string names_of(const std::vector<Choice>& choices) {
  std::string text;
  for (std::size_t i = 0; i < std::min(choices.size(), kMaxChoicesNamed); ++i) {
    text += (i == 0 ? "" : ", ") + in_quotes(choices[i].name);
    if (!choices[i].description.empty() && choices[i].description != choices[i].name)
      text += fmt::format(" ({})", in_quotes(choices[i].description));
  }
  if (choices.size() > kMaxChoicesNamed) text += fmt::format(" and {} more", choices.size() - kMaxChoicesNamed);
  return text;
}

}  // namespace

tl::expected<std::size_t, Problem> choose(const std::vector<Choice>& choices, const std::optional<std::string>& wanted,
                                          std::string_view kind, std::string_view key) {
  const std::string mend = fmt::format("write {} = with one of them in the rig file", key);
  if (!wanted) {
    if (choices.size() == 1) return 0;
    return tl::unexpected(
        Problem{"", 0, 0, fmt::format("the file has {} {}s: {}", choices.size(), kind, names_of(choices)), mend});
  }
  for (const auto of : {&Choice::name, &Choice::description}) {
    const auto is_wanted = [&](const Choice& choice) { return choice.*of == *wanted; };
    const auto count = std::count_if(choices.begin(), choices.end(), is_wanted);
    if (count == 1)
      return static_cast<std::size_t>(std::find_if(choices.begin(), choices.end(), is_wanted) - choices.begin());
    if (count > 1) {
      return tl::unexpected(Problem{"", 0, 0, fmt::format("{} {}s are called {}", count, kind, in_quotes(*wanted)),
                                    "name another, or have the maker mend the file"});
    }
  }
  return tl::unexpected(Problem{"", 0, 0,
                                fmt::format("no {} is called {}; there {} {}", kind, in_quotes(*wanted),
                                            choices.size() == 1 ? "is" : "are", names_of(choices)),
                                mend});
}

}  // namespace luxrig
