#pragma once
/// Collects the problems of a file in any order and returns them in file order.

#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/scene_spec.h"

namespace luxrig {

class ProblemList {
 public:
  explicit ProblemList(std::string file) : file_(std::move(file)) {}

  void add(const FilePosition& in_file, std::string what, std::string mend) {
    add({file_, in_file.line, in_file.column, std::move(what), std::move(mend)});
  }
  void add(Problem problem);

  /// Full at a number of problems that sends a person off to mend the first ones. Further ones are counted, not kept.
  [[nodiscard]] bool full() const { return problems_.size() >= kMax; }
  [[nodiscard]] bool empty() const { return problems_.empty(); }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// Problems of this file by line and column, then those of other files in the order they came.
  [[nodiscard]] std::vector<Problem> take();

 private:
  static constexpr std::size_t kMax = 1000;
  std::string file_;
  std::vector<Problem> problems_;
  std::size_t dropped_ = 0;
};

}  // namespace luxrig
