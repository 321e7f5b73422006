#pragma once
/// Levels of rigs as large as a museum's (aisles_rig.h).

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// `levels-250x500`, `levels-500x500`, `levels-1000x500`: spots × works, direct light, and `…-reflections`: a little of
/// all lamps at all works. error: KKT residual; seconds of the processor.
///   many-at-a-time   the least squares under limits that levels are
///   one-at-a-time    the same by the active set alone (not with --quick: minutes)
///   with-reasons     solve_emittance: why goals are missed, too, which takes three further solves
/// The rig files go to options.export_folder, when given, for `luxrig solve`.
[[nodiscard]] std::vector<BenchRow> bench_levels(const BenchOptions& options);

}  // namespace luxrig
