#pragma once
/// Text of mesh formats made of lines of words: OBJ, its materials, STL. Internal to core/scene.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// Converts to UTF-8 without a byte-order mark. UTF-16 (as saved by Notepad) is recognised by its mark, or by zeros in
/// every other byte of its start.
[[nodiscard]] std::string utf8_of(std::string bytes);

/// One line, its words and their positions.
class TextLine {
 public:
  TextLine(std::string_view text, int number) : text_(text), number_(number) {}

  /// The next word; empty at the end. A word that starts with # begins a comment.
  [[nodiscard]] std::string_view next();
  /// The rest of the line, trimmed.
  [[nodiscard]] std::string_view rest() const;
  [[nodiscard]] int number() const { return number_; }
  /// Column of the word last returned by next(), from 1.
  [[nodiscard]] int column() const { return column_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_, column_ = 1;
};

/// Reads line by line; \n, \r\n and lone \r end a line.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {}  ///< `text` must outlive it
  [[nodiscard]] std::optional<TextLine> next();

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_ = 0;
};

/// A number that fills the word, including ".5", "+1" and "nan". A number beyond double becomes NaN.
[[nodiscard]] std::optional<double> number_of_word(std::string_view word);

/// Problems of one text file, up to a limit, since a garbled file would give thousands.
class TextProblems {
 public:
  explicit TextProblems(std::string file) : file_(std::move(file)) {}
  void add(const TextLine& line, std::string what, std::string mend);
  void add(Problem problem);  ///< of another file
  /// A word in place of a number: with a decimal comma, missing, or anything else.
  void add_no_number(const TextLine& line, std::string_view word, const char* wanted);
  [[nodiscard]] bool full() const { return problems_.size() >= 20; }
  [[nodiscard]] bool empty() const { return problems_.empty(); }
  [[nodiscard]] std::vector<Problem> take() { return std::move(problems_); }

 private:
  std::string file_;
  std::vector<Problem> problems_;
};

}  // namespace luxrig
