#pragma once
/// A correction that is solved beside the control loop, one at a time. The loop never waits for it.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/estimation/gain_estimator.h"

namespace luxrig {

class SolveBeside {
 public:
  using For = GainEstimator::For;
  /// Runs a task once, on any thread.
  using Runner = std::function<void(std::function<void()>)>;

  /// Without a runner, start() solves at once.
  void use(Runner runner) { runner_ = std::move(runner); }
  [[nodiscard]] bool has_runner() const { return static_cast<bool>(runner_); }

  /// Solves with present knowledge, from these levels: what is learned meanwhile counts the next time.
  void start(For what, const GainEstimator& estimator, std::vector<double> levels, Time now);
  [[nodiscard]] bool running() const { return task_ != nullptr; }
  /// What is being solved, or waits to be taken up; none: nothing.
  [[nodiscard]] std::optional<For> what() const { return task_ ? std::optional(task_->what) : std::nullopt; }
  [[nodiscard]] bool done() const { return task_ && task_->done; }

  struct Solved {
    For what = For::round;
    bool holds = false;  ///< no fact that it depends on has changed since it was asked for
    Correction correction;
  };
  /// Requires done().
  [[nodiscard]] Solved take();
  /// What is being solved will not be taken up.
  void drop() { task_.reset(); }
  /// A fact has changed on which solutions depend: levels asked for, lost lamps, what a meter taught.
  void facts_changed() { ++facts_; }

 private:
  struct Task {
    For what = For::round;
    std::uint64_t facts = 0;  ///< when it was asked for
    std::atomic<bool> done{false};
    Correction correction{};
  };
  Runner runner_;
  std::shared_ptr<Task> task_;
  std::uint64_t facts_ = 0;
};

}  // namespace luxrig
