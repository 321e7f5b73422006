#pragma once
/// A year of a gallery that holds its goals.

#include "core/tasks/session.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// The rig with a little daylight through its rooflight, as behind blinds.
[[nodiscard]] Rig with_blinded_daylight(Rig rig);

/// One row: the goals' error in truth (95 %), for a seed. Nothing is computed while nothing changes: nights are one
/// stride, and by day the show runs only when the light at a meter has moved, or an hour is over.
/// session: of with_blinded_daylight().
[[nodiscard]] BenchRow simulated_year(const Session& session, const TransportMatrix& light,
                                      const BenchOptions& options);

}  // namespace luxrig
