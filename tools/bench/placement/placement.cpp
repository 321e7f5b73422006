/// Light placement: the parts of the suite, each in its own file.

#include "tools/bench/suites.h"

namespace luxrig {

std::vector<BenchRow> bench_placement(const BenchOptions& options) {
  if (options.only == "index") return bench_placement_index(options);
  std::vector<BenchRow> rows = bench_placement_recovery(options);
  for (auto part : {bench_placement_scenes, bench_placement_curves, bench_placement_growth}) {
    const auto more = part(options);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

}  // namespace luxrig
