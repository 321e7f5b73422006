#pragma once
/// Levels of rigs as large as a museum's (aisles_rig.h), limits and reasons included.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// `levels-250x500`, `levels-500x500`, `levels-1000x500`: spots × works, direct light; then the same with light from
/// all lamps at all works, as reflections bring it. error: KKT residual; seconds of the processor, of solve_emittance.
/// The rig files go to options.export_folder, when given, for `luxrig solve`.
[[nodiscard]] std::vector<BenchRow> bench_levels(const BenchOptions& options);

}  // namespace luxrig
