#include "tools/luxrig/calibrate/hand_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace luxrig {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::optional<double> lux_of(std::string_view text) {
  std::string number(trimmed(text));
  for (const std::string_view unit : {"lux", "lx"})
    if (number.ends_with(unit)) {
      number = trimmed(std::string_view(number).substr(0, number.size() - unit.size()));
      break;
    }
  // A comma as in half of the world.
  if (std::count(number.begin(), number.end(), ',') == 1 && number.find('.') == std::string::npos)
    std::replace(number.begin(), number.end(), ',', '.');
  double lux = 0;
  const char* end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, lux);
  if (error != std::errc() || rest != end || !(lux >= 0) || lux > kMostLux) return std::nullopt;
  return lux;
}

}  // namespace

std::optional<HandAnswer> hand_answer(std::string_view line) {
  const std::string_view text = trimmed(line);
  if (text.empty()) return HandAnswer{HandAnswer::What::from_file};
  if (text == "s" || text == "skip") return HandAnswer{HandAnswer::What::skip};
  if (text == "n" || text == "next") return HandAnswer{HandAnswer::What::other_place};
  if (text == "q" || text == "quit" || text == "done") return HandAnswer{HandAnswer::What::done};
  const auto lux = lux_of(text);
  if (!lux) return std::nullopt;
  return HandAnswer{HandAnswer::What::reading, *lux};
}

std::string words_of(const HandAnswer& answer) {
  switch (answer.what) {
    case HandAnswer::What::reading:
      return fmt::format("{:.4g} lx", answer.lux);
    case HandAnswer::What::skip:
      return "skip this lamp";
    case HandAnswer::What::other_place:
      return "another place";
    case HandAnswer::What::done:
      return "end";
    case HandAnswer::What::from_file:
      break;
  }
  return "from the file";
}

std::optional<double> last_reading(std::string_view text) {
  text = trimmed(text);
  const auto before = text.find_last_of('\n');
  std::string_view line = before == std::string_view::npos ? text : text.substr(before + 1);
  // Logs begin with a time, and separate by semicolons, tabs or spaces.
  for (const char separator : {';', '\t'})
    if (const auto at = line.find_last_of(separator); at != std::string_view::npos) line = line.substr(at + 1);
  if (const auto lux = lux_of(line)) return lux;
  line = trimmed(line);
  for (const std::string_view unit : {"lux", "lx"})
    if (line.ends_with(unit)) {
      line = trimmed(line.substr(0, line.size() - unit.size()));
      break;
    }
  if (const auto at = line.find_last_of(' '); at != std::string_view::npos) line = line.substr(at + 1);
  return lux_of(line);
}

}  // namespace luxrig
