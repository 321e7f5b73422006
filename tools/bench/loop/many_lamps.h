#pragma once
/// How fast and how well the luxmeters that hang read many lamps: 50 wide spots over a hall with 6 meters, each lamp with
/// an output and a dimmer of its own, all else as stated.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

/// A row for the outputs and one for the curves. error: 95 % of lamps, relative; a lamp that was not read counts as 1.
[[nodiscard]] std::vector<BenchRow> many_lamps(const BenchOptions& options);
inline constexpr const char* kManyLamps = "many lamps";  ///< of BenchOptions::only

}  // namespace luxrig
