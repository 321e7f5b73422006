#pragma once
/// The time left of a call's bound. Blocking on a descriptor takes real time whatever clock the controller uses, so
/// this class, the only one in drivers/, reads the real clock. No value that is sent or reported depends on it.

#include <algorithm>
#include <chrono>

namespace luxrig {

class Deadline {
 public:
  explicit Deadline(std::chrono::milliseconds budget) : end_(std::chrono::steady_clock::now() + budget) {}

  /// Rounded up, so that a wait of this length does pass the deadline; 0 once it has passed.
  [[nodiscard]] std::chrono::milliseconds left() const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end_ - std::chrono::steady_clock::now());
    return std::max(left, std::chrono::milliseconds(0));
  }
  [[nodiscard]] bool passed() const { return left().count() == 0; }

 private:
  std::chrono::steady_clock::time_point end_;
};

}  // namespace luxrig
