/// Evaluators against closed forms: the families of cases, each in its file.

#include "tools/bench/analytic_case.h"
#include "tools/bench/suites.h"

namespace luxrig {

std::vector<BenchRow> bench_analytic(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const auto add : {add_point_rows, add_flux_rows, add_area_rows, add_enclosure_rows, add_furnace_rows,
                         add_reflection_rows, add_daylight_rows, add_error_bar_rows})
    add(options, rows);
  return rows;
}

}  // namespace luxrig
