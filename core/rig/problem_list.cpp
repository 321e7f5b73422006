#include "core/rig/problem_list.h"

#include <algorithm>
#include <tuple>

namespace luxrig {

void ProblemList::add(Problem problem) {
  if (full()) {
    ++dropped_;
    return;
  }
  problems_.push_back(std::move(problem));
}

std::vector<Problem> ProblemList::take() {
  std::stable_sort(problems_.begin(), problems_.end(), [this](const Problem& a, const Problem& b) {
    const bool a_elsewhere = a.file != file_, b_elsewhere = b.file != file_;
    if (a_elsewhere || b_elsewhere) return a_elsewhere < b_elsewhere;
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  if (dropped_ > 0) {
    problems_.push_back(
        {file_, 0, 0, std::to_string(dropped_) + " more problems are not shown", "mend those above and check again"});
    dropped_ = 0;
  }
  return std::move(problems_);
}

}  // namespace luxrig
