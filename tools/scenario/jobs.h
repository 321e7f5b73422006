#pragma once
/// Runs in several processes: the stepped clock is one per process.

#include <functional>
#include <vector>

#include "tools/scenario/outcome.h"

namespace luxrig::scenario {

/// Outcomes of run(0) … run(count - 1), in that order, whatever the number of processes. A run whose process dies has
/// an error. With one job, everything runs in this process.
/// Call before any thread of this process begins, or after all have ended.
/// done   called in this process after every run, with the number of runs done
[[nodiscard]] std::vector<Outcome> run_all(std::size_t count, int jobs, const std::function<Outcome(std::size_t)>& run,
                                           const std::function<void(std::size_t)>& done = {});

}  // namespace luxrig::scenario
