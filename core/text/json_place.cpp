#include "core/text/json_place.h"

#include <algorithm>
#include <charconv>
#include <string>

namespace luxrig {
namespace {

/// Walks over well-formed text; never past its end.
class JsonWalk {
 public:
  explicit JsonWalk(std::string_view text) : text_(text) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
  }
  bool take(char c) {
    skip_blanks();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  /// The text between quotes as written.
  std::string_view take_string() {
    if (!take('"')) return {};
    const std::size_t start = at_;
    while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
    at_ = std::min(at_, text_.size());
    const std::string_view inside = text_.substr(start, at_ - start);
    take('"');
    return inside;
  }
  /// Skips a whole value, however deep.
  void skip_value() {
    int depth = 0;
    do {
      skip_blanks();
      const char c = peek();
      if (c == '"') {
        take_string();
      } else if (c == '{' || c == '[') {
        ++at_, ++depth;
        continue;
      } else if (c == '}' || c == ']') {
        ++at_, --depth;
      } else if (c == ',' || c == ':') {
        ++at_;
        continue;
      } else {
        const std::size_t end = text_.find_first_of(",:]} \t\r\n\"[{", at_);
        at_ = end == std::string_view::npos ? text_.size() : end;
      }
      if (depth == 0) return;
    } while (at_ < text_.size());
  }
  /// Moves to the value of a key or index in the object or array that begins here. False if there is none.
  bool enter(std::string_view step) {
    skip_blanks();
    if (take('{')) {
      while (peek() != '\0') {
        skip_blanks();
        const std::string_view key = take_string();
        if (!take(':')) return false;
        skip_blanks();
        if (key == step) return true;
        skip_value();
        if (!take(',')) return false;
      }
      return false;
    }
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
    if (error != std::errc{} || end != step.data() + step.size() || !take('[')) return false;
    for (skip_blanks(); index > 0; --index) {
      skip_value();
      if (!take(',')) return false;
      skip_blanks();
    }
    return peek() != ']' && peek() != '\0';
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

JsonPlace place_in_json(std::string_view text, std::string_view path) {
  JsonWalk walk(text);
  walk.skip_blanks();
  std::size_t found = walk.at();
  while (path.starts_with('/')) {
    path.remove_prefix(1);
    const std::size_t end = std::min(path.find('/'), path.size());
    if (!walk.enter(path.substr(0, end))) break;
    found = walk.at();
    path.remove_prefix(end);
  }
  const std::string_view before = text.substr(0, found);
  const std::size_t newline = before.rfind('\n');
  return {1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
          1 + static_cast<int>(newline == std::string_view::npos ? found : found - newline - 1)};
}

}  // namespace luxrig
