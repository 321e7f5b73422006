#pragma once
/// What each suite runs; the table is in bench.cpp.

#include <vector>

#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

[[nodiscard]] std::vector<BenchRow> bench_analytic(const BenchOptions& options);

}  // namespace luxrig
