#include "core/photometry/files/file_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

namespace luxrig::file_text {
namespace {

constexpr std::size_t kMaxProblems = 20;
constexpr std::uintmax_t kMaxPhotometryBytes = 64u << 20;
constexpr double kMinSpacing_deg = 1e-6;

// Old files contain form feeds, NUL and ^Z. Commas separate like blanks.
bool is_separator(char c) { return static_cast<unsigned char>(c) <= ' ' || c == ','; }

}  // namespace

void Cursor::advance() {
  const char c = text_[offset_++];
  if (c == '\n' || (c == '\r' && (at_end() || text_[offset_] != '\n'))) {
    ++line_;
    line_start_ = offset_;
  }
}

std::string_view Cursor::take_line() {
  const std::size_t start = offset_;
  while (!at_end() && peek() != '\n' && peek() != '\r') advance();
  const std::string_view line = text_.substr(start, offset_ - start);
  if (!at_end() && peek() == '\r') {
    advance();
    if (!at_end() && peek() == '\n') advance();
  } else if (!at_end()) {
    advance();
  }
  return line;
}

std::string_view Cursor::take_token() {
  skip_separators();
  const std::size_t start = offset_;
  while (!at_end() && !is_separator(peek())) advance();
  return text_.substr(start, offset_ - start);
}

void Cursor::skip_separators() {
  while (!at_end() && is_separator(peek())) advance();
}

std::string_view without_bom(std::string_view text) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  return text;
}

std::optional<std::string> from_utf16(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (text.size() < 4) return std::nullopt;
  const bool little_mark = byte(0) == 0xFF && byte(1) == 0xFE;
  const bool big_mark = byte(0) == 0xFE && byte(1) == 0xFF;
  const bool little = little_mark || (byte(0) != 0 && byte(1) == 0 && byte(2) != 0 && byte(3) == 0);
  const bool big = big_mark || (byte(0) == 0 && byte(1) != 0 && byte(2) == 0 && byte(3) != 0);
  if (!little && !big) return std::nullopt;
  std::string out;
  out.reserve(text.size() / 2);
  for (std::size_t i = little_mark || big_mark ? 2 : 0; i + 1 < text.size(); i += 2) {
    const unsigned unit = little ? byte(i) | byte(i + 1) << 8 : byte(i + 1) | byte(i) << 8;
    if (unit < 0x80) {
      out += static_cast<char>(unit);
    } else if (unit < 0x800) {
      out += {static_cast<char>(0xC0 | unit >> 6), static_cast<char>(0x80 | (unit & 0x3F))};
    } else if (unit >= 0xD800 && unit < 0xE000) {
      out += '?';  // half of a character, which numbers and keys never need
    } else {
      out += {static_cast<char>(0xE0 | unit >> 12), static_cast<char>(0x80 | (unit >> 6 & 0x3F)),
              static_cast<char>(0x80 | (unit & 0x3F))};
    }
  }
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string excerpt(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > 40 ? "…'" : "'");
}

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 6);
  return {buffer.data(), end.ptr};
}

std::optional<double> number_of(std::string_view token) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || error != std::errc() || end != token.data() + token.size() || !std::isfinite(value)) return {};
  return value;
}

bool is_radiometric(std::string_view lowered_line) {
  return lowered_line.find("w/sr") != std::string_view::npos ||
         lowered_line.find("radiometric units") != std::string_view::npos;
}

std::string words_of_rest(Cursor cursor, const std::string& after) {
  cursor.skip_separators();
  if (cursor.at_end()) return "";
  const int line = cursor.at().line;
  std::size_t values = 0;
  std::string_view first;
  while (!cursor.at_end()) {
    const std::string_view token = cursor.take_token();
    if (values == 0) first = token;
    values += !token.empty();
  }
  if (values == 1 && (first == "END" || first == "end")) return "";  // some programs end the file this way
  return "from line " + std::to_string(line) + " on, " +
         (values == 1 ? "1 value" : std::to_string(values) + " values") + " after " + after +
         " are not read: " + excerpt(first) + (values > 1 ? " …" : "");
}

void ProblemLog::add(At at, std::string what, std::string mend) {
  if (!full()) problems_.push_back({file_name_, at.line, at.column, std::move(what), std::move(mend)});
}

bool ProblemLog::full() const { return problems_.size() >= kMaxProblems; }

At NumberReader::place() {
  cursor_.skip_separators();
  return cursor_.at();
}

std::optional<double> NumberReader::number(const std::string& what, double least, double most) {
  const At at = place();
  const std::string_view token = cursor_.take_token();
  if (token.empty()) {
    problems_.add(at, "the file ends before the " + what, "give the whole file");
    return std::nullopt;
  }
  const std::optional<double> value = number_of(token);
  if (!value) {
    problems_.add(at, what + " " + excerpt(token) + " is not a number", "write a plain number");
    broken_ = true;
    return std::nullopt;
  }
  if (*value < least || *value > most) {
    problems_.add(at, what + " " + excerpt(token) + " is out of range",
                  "give a value from " + number_text(least) + " to " + number_text(most));
  }
  return value;
}

std::optional<std::size_t> NumberReader::whole(const std::string& what, std::size_t least, std::size_t most) {
  const At at = place();
  const std::size_t before = problems_.size();
  const auto value = number(what, static_cast<double>(least), static_cast<double>(most));
  if (!value) return std::nullopt;
  if (problems_.size() > before || problems_.full()) return least;  // reported; continue
  if (*value != std::floor(*value)) {
    problems_.add(at, what + " is not a whole number", "write a whole number");
    return least;
  }
  return static_cast<std::size_t>(*value);
}

bool NumberReader::numbers(const std::string& what, std::size_t count, double least, double most,
                           std::vector<double>& out) {
  out.reserve(std::min(count, cursor_.remaining() / 2 + 1));  // never more than the text can hold
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = number(what, least, most);
    if (!value) {
      if (!problems_.empty() && !broken_) {
        problems_.last().what.append(" ").append(std::to_string(i + 1)).append(" of ").append(std::to_string(count));
      }
      return false;
    }
    if (problems_.full()) return false;
    out.push_back(*value);
  }
  return problems_.empty();
}

bool check_ascending(const std::string& name, const std::vector<double>& angles_deg, At at, ProblemLog& problems) {
  for (std::size_t i = 1; i < angles_deg.size(); ++i) {
    if (angles_deg[i] - angles_deg[i - 1] >= kMinSpacing_deg) continue;
    problems.add(
        at,
        name + " angles do not ascend: " + number_text(angles_deg[i]) + " follows " + number_text(angles_deg[i - 1]),
        "list each angle once, ascending");
    return false;
  }
  return true;
}

Checked<std::string> read_text(const std::filesystem::path& path, const char* kind) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{path.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {  // a pipe would block
    return refuse("no such photometric file", "correct its name, relative to the rig file");
  }
  const auto bytes = std::filesystem::file_size(path, error);
  if (error || bytes > kMaxPhotometryBytes)
    return refuse("larger than 64 MiB", std::string("give an ") + kind + " file");
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in.good() && !in.eof()) return refuse("cannot be read", "check that you may read it");
  return text;
}

}  // namespace luxrig::file_text
