#pragma once
/// On-off lights among lights that dim, for `luxrig bench nnls`.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// relays-N: N lamps on relays and 8 that dim, 4 m above a hall of 30 m by 20 m with 300 points. Every tenth point has
/// a limit; goals are random. Medians of 20 halls (3 with quick). `branch-and-bound` is compared with `all-dim`, which
/// bounds it from below. error: the normalised error of solve_emittance.
[[nodiscard]] std::vector<BenchRow> bench_switched(const BenchOptions& options);

}  // namespace luxrig
