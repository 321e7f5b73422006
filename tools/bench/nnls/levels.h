#pragma once
/// Levels of rigs as large as a museum's (aisles_rig.h).

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// `levels-250x500`, `levels-500x500`, `levels-1000x500`: spots × works, direct light; `…-reflections`: with a little
/// light of all lamps at all works. error: KKT residual. seconds: processor time.
///   many-at-a-time   the least squares under limits that give the levels
///   one-at-a-time    the same by the active set alone (not with --quick: minutes)
///   with-reasons     solve_emittance: also why goals are missed, which takes three more solves
/// The rig files go to options.export_folder, if given, for `luxrig solve`.
[[nodiscard]] std::vector<BenchRow> bench_levels(const BenchOptions& options);

}  // namespace luxrig
