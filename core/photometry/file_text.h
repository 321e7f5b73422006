#pragma once
/// Text of a photometric file: places in it, its lines and numbers, and what is wrong with them. For the parsers alone.

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

/// A place in the text that counts lines; \n, \r\n and lone \r end one.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}  ///< `text` must outlive it

  [[nodiscard]] bool at_end() const { return offset_ >= text_.size(); }
  [[nodiscard]] char peek() const { return text_[offset_]; }
  [[nodiscard]] At at() const { return {line_, static_cast<int>(offset_ - line_start_) + 1}; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - offset_; }

  void advance();
  /// The rest of this line without its end; the cursor moves to the next line.
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
/// UTF-16 with or without byte order mark, as Notepad may save it, as UTF-8; nothing for any other text.
[[nodiscard]] std::optional<std::string> from_utf16(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] std::string lower(std::string_view text);            ///< ASCII letters only
[[nodiscard]] std::string excerpt(std::string_view text);          ///< for messages: quoted, short, printable
[[nodiscard]] std::string number_text(double value);               ///< six digits
[[nodiscard]] std::optional<double> number_of(std::string_view);   ///< a plain finite number, whole text; "+1" too
[[nodiscard]] bool is_radiometric(std::string_view lowered_line);  ///< speaks of W/sr or radiometric units

/// What stands from here to the end, when it is more than blanks and control characters: "from line 40 on, 12 values
/// after the last candela value are not read: …". Empty: nothing.
[[nodiscard]] std::string words_of_rest(Cursor cursor, const std::string& after);

/// Problems of one file, up to a limit: a garbled one would give thousands.
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

/// Free-form numbers in a row, each named for the message it gives when it is wrong.
class NumberReader {
 public:
  NumberReader(Cursor& cursor, ProblemLog& problems) : cursor_(cursor), problems_(problems) {}

  /// Place of the next token.
  [[nodiscard]] At place();
  /// The next number; nothing at the end or at a token that is no number (then reading must stop). One out of range is
  /// a problem, and returned.
  std::optional<double> number(const std::string& what, double least, double most);
  std::optional<std::size_t> whole(const std::string& what, std::size_t least, std::size_t most);
  /// `count` numbers into `out`; stops at the first that cannot be read. False with any problem.
  bool numbers(const std::string& what, std::size_t count, double least, double most, std::vector<double>& out);

 private:
  Cursor& cursor_;
  ProblemLog& problems_;
  bool broken_ = false;  // a token that is no number: what follows has lost its meaning
};

/// True when each angle exceeds the one before by 1e-6°; else adds a problem.
bool check_ascending(const std::string& name, const std::vector<double>& angles_deg, At at, ProblemLog& problems);

/// Text of a file of at most 64 MiB. `kind` names the format for the message.
[[nodiscard]] Checked<std::string> read_text(const std::filesystem::path& path, const char* kind);

}  // namespace luxrig::file_text
