#pragma once
/// A table for a terminal: columns as wide as their widest cell.

#include <string>
#include <vector>

namespace luxrig {

class Table {
 public:
  /// A heading that starts with '>' aligns its column to the right.
  explicit Table(std::vector<std::string> headings);
  void row(std::vector<std::string> cells);
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::string> headings_;
  std::vector<bool> right_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace luxrig
