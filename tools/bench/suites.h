#pragma once
/// The function of each suite; the table is in bench.cpp.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

[[nodiscard]] std::vector<BenchRow> bench_analytic(const BenchOptions& options);

/// Time against error of every evaluator in furnished rooms, judged by converged path tracing; also properties that
/// must hold at any accuracy.
[[nodiscard]] std::vector<BenchRow> bench_transport(const BenchOptions& options);

/// Modbus TCP and RTU with many units, some dead. error: how much later than wanted the median meter is read.
[[nodiscard]] std::vector<BenchRow> bench_modbus_load(const BenchOptions& options);

/// 64 universes at 44 Hz through the daemon's bus thread and a socket to simulated receivers, sACN and Art-Net. error:
/// 99th percentile of |frame interval - 1/44 s| over that period. The encode path has its own row, in seconds per
/// frame.
[[nodiscard]] std::vector<BenchRow> bench_dmx_load(const BenchOptions& options);

/// 64 axes, 32 heads, on a simulated CAN bus that measures their timing. error: 99th percentile of |cycle - 10 ms| over
/// 10 ms, or how much later than the closed form the last head arrives.
[[nodiscard]] std::vector<BenchRow> bench_axes_load(const BenchOptions& options);

/// Hundreds of faults of every kind on every bus, over simulated devices. error: share of cases that left a lamp or an
/// axis in a state that was never asked for, or that did not recover. seconds: longest recovery.
[[nodiscard]] std::vector<BenchRow> bench_faults(const BenchOptions& options);

/// Rigs whose truth differs from their files as real ones do. error: of the light at goals after calibrating.
[[nodiscard]] std::vector<BenchRow> bench_loop(const BenchOptions& options);
/// Faults that are named by readings alone, false alarms, and corrections beside PI loops.
[[nodiscard]] std::vector<BenchRow> bench_hold(const BenchOptions& options);

/// Pan-tilt heads that hang and turn otherwise than stated, calibrated by a camera. error: 95th percentile, in degrees,
/// of where the beam falls. seconds: processor time of the estimate, a head.
[[nodiscard]] std::vector<BenchRow> bench_heads(const BenchOptions& options);

/// Non-negative least squares, cold, warm and limited. error: worst KKT residual. seconds: processor time.
[[nodiscard]] std::vector<BenchRow> bench_nnls(const BenchOptions& options);

/// The whole placement suite: recovery and scenes; index, curves and growth by name only.
[[nodiscard]] std::vector<BenchRow> bench_placement(const BenchOptions& options);

/// Known lights found again, with their number given or open. A row for each of 100 rooms (3 with quick), then the
/// median, the 90th percentile (which is judged) and the worst of every column separately. `found`: share found again
/// within 3 cm and 2 % of flux.
[[nodiscard]] std::vector<BenchRow> bench_placement_recovery(const BenchOptions& options);

/// Every scene and goal by every method, with the certified bound for as many lights. quick: the first scene.
[[nodiscard]] std::vector<BenchRow> bench_placement_scenes(const BenchOptions& options);

/// Error against time, 20 seeds; `note` has the quartiles.
[[nodiscard]] std::vector<BenchRow> bench_placement_curves(const BenchOptions& options);

/// Candidates from 10⁴ to 10⁶, points from 10² to 10⁴.
[[nodiscard]] std::vector<BenchRow> bench_placement_growth(const BenchOptions& options);

/// The best complement of a residual, by scans and by a k-d tree (`--only index`). error: largest share of the best
/// product that an answer lacks. seconds: processor time of the median of ten queries. quick: without 3 000 points.
[[nodiscard]] std::vector<BenchRow> bench_placement_index(const BenchOptions& options);

/// Shadow edges by search; lights that bring out relief, by every method; their number; how far they move if the object
/// is turned, scaled, decimated or noisy. On the generated targets; on five more with a data folder.
[[nodiscard]] std::vector<BenchRow> bench_highlight(const BenchOptions& options);

/// Painting light on surfaces. Patches and groups of a colonnade of 10⁴ to 10⁷ triangles (quick: 10⁶), strokes on a
/// million; the apartment with a data folder. error: of the area of all patches. seconds: by the wall; of strokes, the
/// 95th percentile.
[[nodiscard]] std::vector<BenchRow> bench_goals(const BenchOptions& options);

/// Four sACN universes at 44 Hz to a sink on loopback for 40 s (6 s with quick), with path tracing on all cores. Prints
/// the histogram of the intervals by the kernel's arrival stamps. error: p99 deviation over the period. Then the loads
/// below.
[[nodiscard]] std::vector<BenchRow> bench_buses(const BenchOptions& options);

}  // namespace luxrig
