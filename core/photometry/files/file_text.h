#pragma once
/// Text of a photometric file: positions, lines, numbers, and its problems. For the parsers only.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig::file_text {

/// Line and column, from 1; 0 = the whole file.
struct At {
  int line = 0;
  int column = 0;
};

/// A position in the text that counts lines; \n, \r\n and lone \r end a line.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}  ///< `text` must outlive it

  [[nodiscard]] bool at_end() const { return offset_ >= text_.size(); }
  [[nodiscard]] char peek() const { return text_[offset_]; }
  [[nodiscard]] At at() const { return {line_, static_cast<int>(offset_ - line_start_) + 1}; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - offset_; }

  void advance();
  /// The rest of this line, without its end. The cursor moves to the next line.
  std::string_view take_line();
  /// The next run of characters between separators (blanks, control characters, commas); empty at the end.
  std::string_view take_token();
  void skip_separators();

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
};

[[nodiscard]] std::string_view without_bom(std::string_view text);
/// Converts UTF-16, with or without byte-order mark (as saved by Notepad), to UTF-8; nullopt for any other text.
[[nodiscard]] std::optional<std::string> from_utf16(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] std::string lower(std::string_view text);            ///< ASCII letters only
[[nodiscard]] std::string excerpt(std::string_view text);          ///< for messages: quoted, short, printable
[[nodiscard]] std::string number_text(double value);               ///< six digits
[[nodiscard]] std::optional<double> number_of(std::string_view);   ///< a plain finite number, whole text; "+1" too
[[nodiscard]] bool is_radiometric(std::string_view lowered_line);  ///< mentions W/sr or radiometric units

/// Describes the remaining text, if it is more than blanks and control characters: "from line 40 on, 12 values after
/// the last candela value are not read: …". Empty = nothing remains.
[[nodiscard]] std::string words_of_rest(Cursor cursor, const std::string& after);

/// Problems of one file, up to a limit, since a garbled file would give thousands.
class ProblemLog {
 public:
  explicit ProblemLog(std::string file_name) : file_name_(std::move(file_name)) {}
  void add(At at, std::string what, std::string mend);
  [[nodiscard]] bool empty() const { return problems_.empty(); }
  [[nodiscard]] bool full() const;
  [[nodiscard]] std::size_t size() const { return problems_.size(); }
  [[nodiscard]] Problem& last() { return problems_.back(); }
  void clear() { problems_.clear(); }
  [[nodiscard]] std::vector<Problem> take() { return std::move(problems_); }

 private:
  std::string file_name_;
  std::vector<Problem> problems_;
};

/// Reads free-form numbers in sequence, each with a name for its error message.
class NumberReader {
 public:
  NumberReader(Cursor& cursor, ProblemLog& problems) : cursor_(cursor), problems_(problems) {}

  /// Place of the next token.
  [[nodiscard]] At place();
  /// The next number; nullopt at the end or at a token that is not a number (reading must then stop). A number out of
  /// range is a problem, but is returned.
  std::optional<double> number(const std::string& what, double least, double most);
  std::optional<std::size_t> whole(const std::string& what, std::size_t least, std::size_t most);
  /// Reads `count` numbers into `out`; stops at the first unreadable one. False if there was any problem.
  bool numbers(const std::string& what, std::size_t count, double least, double most, std::vector<double>& out);

 private:
  Cursor& cursor_;
  ProblemLog& problems_;
  bool broken_ = false;  // a token was not a number, so the rest has lost its meaning
};

/// True if each angle exceeds the previous one by 1e-6°; otherwise adds a problem.
bool check_ascending(const std::string& name, const std::vector<double>& angles_deg, At at, ProblemLog& problems);

/// Text of a file of at most 64 MiB. `kind` names the format for the message.
[[nodiscard]] Checked<std::string> read_text(const std::filesystem::path& path, const char* kind);

}  // namespace luxrig::file_text
