#include "core/scene/mesh/mesh_text.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }

void append_utf8(std::string& out, std::uint32_t code) {
  const auto byte = [&](std::uint32_t value) { out += static_cast<char>(value); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xc0 | code >> 6), byte(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    byte(0xe0 | code >> 12), byte(0x80 | (code >> 6 & 0x3f)), byte(0x80 | (code & 0x3f));
  } else {
    byte(0xf0 | code >> 18), byte(0x80 | (code >> 12 & 0x3f)), byte(0x80 | (code >> 6 & 0x3f)),
        byte(0x80 | (code & 0x3f));
  }
}

/// Unpaired surrogates become U+FFFD.
std::string utf8_of_utf16(std::string_view bytes, bool big_endian) {
  std::string out;
  out.reserve(bytes.size() / 2 + bytes.size() / 8);
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return std::uint32_t{big_endian ? first : second} << 8 | (big_endian ? second : first);
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xd800 && code < 0xe000) {
      const std::uint32_t low = code < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
      if (low >= 0xdc00 && low < 0xe000) {
        code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        i += 2;
      } else {
        code = 0xfffd;
      }
    }
    append_utf8(out, code);
  }
  return out;
}

}  // namespace

std::string utf8_of(std::string bytes) {
  using namespace std::string_view_literals;
  const std::string_view text = bytes;
  if (text.starts_with("\xef\xbb\xbf"sv)) return bytes.substr(3);
  if (text.starts_with("\xff\xfe"sv)) return utf8_of_utf16(text.substr(2), false);
  if (text.starts_with("\xfe\xff"sv)) return utf8_of_utf16(text.substr(2), true);
  if (text.size() >= 4) {
    const auto zero = [&](std::size_t i) { return text[i] == '\0'; };
    if (!zero(0) && zero(1) && !zero(2) && zero(3)) return utf8_of_utf16(text, false);
    if (zero(0) && !zero(1) && zero(2) && !zero(3)) return utf8_of_utf16(text, true);
  }
  return bytes;
}

std::string_view TextLine::next() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  column_ = static_cast<int>(std::min<std::size_t>(at_, 1'000'000)) + 1;
  const std::size_t begin = at_;
  if (begin < text_.size() && text_[begin] == '#') {
    at_ = text_.size();
    return {};
  }
  while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextLine::rest() const {
  std::size_t begin = at_, end = text_.size();
  while (begin < end && is_blank(text_[begin])) ++begin;
  while (end > begin && is_blank(text_[end - 1])) --end;
  return text_.substr(begin, end - begin);
}

std::optional<TextLine> TextLines::next() {
  if (at_ >= text_.size()) return std::nullopt;
  ++number_;
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  const std::string_view line = text_.substr(at_, end - at_);
  at_ = end + (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n' ? 2 : 1);
  return TextLine(line, number_);
}

std::optional<double> number_of_word(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || stop != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc()) return value;
  return word.find_first_of("eE") != std::string_view::npos && word.find('-', 1) != std::string_view::npos
             ? 0  // too small for double
             : std::numeric_limits<double>::quiet_NaN();
}

void TextProblems::add(const TextLine& line, std::string what, std::string mend) {
  if (!full()) problems_.push_back({file_, line.number(), line.column(), std::move(what), std::move(mend)});
}

void TextProblems::add(Problem problem) {
  if (!full()) problems_.push_back(std::move(problem));
}

void TextProblems::add_no_number(const TextLine& line, std::string_view word, const char* wanted) {
  if (word.empty()) return add(line, std::string("ends where ") + wanted + " should stand", "export it again");
  const auto comma = word.find(',');
  std::string pointed(word);
  if (comma != std::string_view::npos) pointed[comma] = '.';
  if (comma != std::string_view::npos && number_of_word(pointed))
    return add(line, in_quotes(word) + " has a decimal comma",
               "export it with decimal points, as " + in_quotes(pointed));
  add(line, in_quotes(word) + " stands where " + wanted + " should", "export it again");
}

}  // namespace luxrig
