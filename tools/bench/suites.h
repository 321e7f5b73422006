#pragma once
/// What each suite runs; the table is in bench.cpp.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

[[nodiscard]] std::vector<BenchRow> bench_analytic(const BenchOptions& options);

/// Time against error of every evaluator in furnished rooms, against converged path tracing; what must hold besides.
[[nodiscard]] std::vector<BenchRow> bench_transport(const BenchOptions& options);

/// Modbus TCP and RTU with many units, some dead: error is by how much the median meter is read later than wanted.
[[nodiscard]] std::vector<BenchRow> bench_modbus_load(const BenchOptions& options);

/// 64 universes at 44 Hz through the daemon's bus thread and a socket to simulated receivers, sACN and Art-Net: error
/// is the 99th percentile of |frame interval - 1/44 s| over that period; the encode path apart, in seconds per frame.
[[nodiscard]] std::vector<BenchRow> bench_dmx_load(const BenchOptions& options);

/// 64 axes, 32 heads, on a simulated CAN bus that keeps their time: error is the 99th percentile of |cycle - 10 ms|
/// over 10 ms, or by how much the last head arrives later than the closed form has it.
[[nodiscard]] std::vector<BenchRow> bench_axes_load(const BenchOptions& options);

/// Every kind of fault of every bus, by the hundred, over simulated devices: error is the share of cases that left a
/// lamp or an axis in a state nobody asked for, or did not recover; seconds are of the longest recovery.
[[nodiscard]] std::vector<BenchRow> bench_faults(const BenchOptions& options);

/// Non-negative least squares, cold, warm and limited: error is the worst KKT residual, seconds are of the processor.
[[nodiscard]] std::vector<BenchRow> bench_nnls(const BenchOptions& options);

/// All of the placement suite: recovery and scenes; index, curves and growth by name only.
[[nodiscard]] std::vector<BenchRow> bench_placement(const BenchOptions& options);

/// Known lights found again, their number given and open: a row for each of 100 rooms (3 with quick), then the median,
/// the 90th percentile (which is judged) and the worst of every column by itself; `found` is the share found again
/// within 3 cm and 2 % of flux.
[[nodiscard]] std::vector<BenchRow> bench_placement_recovery(const BenchOptions& options);

/// Every scene and goal by every method, with the certified bound for as many lights. quick: the first scene.
[[nodiscard]] std::vector<BenchRow> bench_placement_scenes(const BenchOptions& options);

/// Error against time, 20 seeds; `note` has the quartiles.
[[nodiscard]] std::vector<BenchRow> bench_placement_curves(const BenchOptions& options);

/// Candidates from 10⁴ to 10⁶, points from 10² to 10⁴.
[[nodiscard]] std::vector<BenchRow> bench_placement_growth(const BenchOptions& options);

/// The best complement of a residual, by scans and by a k-d tree (`--only index`): error is the largest share of the
/// best product that an answer lacks; seconds of the processor, of the query in the middle of ten. quick: no 3 000
/// points.
[[nodiscard]] std::vector<BenchRow> bench_placement_index(const BenchOptions& options);

/// Shadow edges by search, lights that bring out relief by every method, their number, and how far they move when the
/// object is turned, scaled, decimated or noisy. The generated targets; with a folder of data five more.
[[nodiscard]] std::vector<BenchRow> bench_highlight(const BenchOptions& options);

/// 40 s (6 s with quick) of four sACN universes at 44 Hz to a sink on loopback, path tracing on all cores meanwhile.
/// Prints the histogram of the intervals by the kernel's arrival stamps. error: p99 deviation over the period. Then the
/// loads below.
[[nodiscard]] std::vector<BenchRow> bench_buses(const BenchOptions& options);

}  // namespace luxrig
