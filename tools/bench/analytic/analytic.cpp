/// Evaluators against closed forms: the families of cases, each in its file.

#include <string_view>
#include <utility>

#include "tools/bench/analytic/case.h"
#include "tools/bench/suites.h"

namespace luxrig {

std::vector<BenchRow> bench_analytic(const BenchOptions& options) {
  using Add = void (*)(const BenchOptions&, std::vector<BenchRow>&);
  constexpr std::pair<std::string_view, Add> kFamilies[] = {
      {"point", add_point_rows},         {"flux", add_flux_rows},           {"area", add_area_rows},
      {"enclosure", add_enclosure_rows}, {"furnace", add_furnace_rows},     {"reflection", add_reflection_rows},
      {"daylight", add_daylight_rows},   {"error-bars", add_error_bar_rows}};
  std::vector<BenchRow> rows;
  for (const auto& [name, add] : kFamilies)
    if (name.starts_with(options.only)) add(options, rows);
  return rows;
}

}  // namespace luxrig
