#pragma once
/// Text of the mesh formats that are lines of words: OBJ, its materials, STL. Internal to core/scene.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// As UTF-8 without a byte order mark: UTF-16 (as Notepad saves it) is known by its mark, or by every other byte of its
/// beginning being zero.
[[nodiscard]] std::string utf8_of(std::string bytes);

/// One line, its words and where they stand.
class TextLine {
 public:
  TextLine(std::string_view text, int number) : text_(text), number_(number) {}

  /// The next word; empty at the end. What follows a # at its beginning is a comment.
  [[nodiscard]] std::string_view next();
  /// All that is left, without blanks at its ends.
  [[nodiscard]] std::string_view rest() const;
  [[nodiscard]] int number() const { return number_; }
  /// Column of the word that next() gave last, from 1.
  [[nodiscard]] int column() const { return column_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_, column_ = 1;
};

/// Line after line; \n, \r\n and lone \r end one.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {}  ///< `text` must outlive it
  [[nodiscard]] std::optional<TextLine> next();

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_ = 0;
};

/// A number, whole; ".5", "+1" and "nan" are such. One beyond double is not a number (NaN).
[[nodiscard]] std::optional<double> number_of_word(std::string_view word);

/// Problems of one file of text, up to a limit: a garbled one would give thousands.
class TextProblems {
 public:
  explicit TextProblems(std::string file) : file_(std::move(file)) {}
  void add(const TextLine& line, std::string what, std::string mend);
  void add(Problem problem);  ///< of a further file
  /// A word where a number should stand: with a decimal comma, none at all, or something else.
  void add_no_number(const TextLine& line, std::string_view word, const char* wanted);
  [[nodiscard]] bool full() const { return problems_.size() >= 20; }
  [[nodiscard]] bool empty() const { return problems_.empty(); }
  [[nodiscard]] std::vector<Problem> take() { return std::move(problems_); }

 private:
  std::string file_;
  std::vector<Problem> problems_;
};

}  // namespace luxrig
