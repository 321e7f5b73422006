#include "core/show/controller/solve_beside.h"

#include <utility>

#include "core/check.h"

namespace luxrig {

void SolveBeside::start(For what, const GainEstimator& estimator, std::vector<double> levels, Time now) {
  task_ = std::make_shared<Task>();
  task_->what = what;
  task_->facts = facts_;
  if (!runner_) {
    task_->correction = estimator.correct(levels, now, what);
    task_->done = true;
    return;
  }
  // The task owns everything it uses.
  runner_(
      [to = task_, known = std::make_shared<const GainEstimator>(estimator), levels = std::move(levels), now, what] {
        to->correction = known->correct(levels, now, what);
        to->done = true;
      });
}

SolveBeside::Solved SolveBeside::take() {
  LUXRIG_CHECK(done(), "nothing is solved");
  const std::shared_ptr<Task> task = std::exchange(task_, nullptr);
  return {task->what, task->facts == facts_, std::move(task->correction)};
}

}  // namespace luxrig
