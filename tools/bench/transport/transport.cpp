/// Evaluators in furnished rooms: the parts of the suite, each in its own file.

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "tools/bench/suites.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

/// Writes the rooms for another program, with our converged answer beside them.
std::vector<BenchRow> exported(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const auto make :
       {+[] { return make_box_room(); }, +[] { return make_eight_room_flat(); }, +[] { return make_gallery_hall(); }}) {
    const TransportCase one(make());
    if (!wanted_case(options, one.room.name)) continue;
    std::string trouble = export_for_radiance(one.room, options.export_folder);
    const Reference reference = reference_of(one, options);
    if (trouble.empty()) trouble = reference.refused;
    if (trouble.empty()) {
      std::ofstream out(options.export_folder / (one.room.name + ".lux"));
      for (const double lux : reference.lux) out << fmt::format("{:.9g}\n", lux);
    } else {
      fmt::print(stderr, "{}\n", trouble);
    }
    Measured run;
    run.seconds = reference.seconds;
    run.refused = trouble;
    rows.push_back(
        transport_row(one.room.name + "-exported", "path", reference.rms_error, run, std::nullopt, std::nullopt));
  }
  return rows;
}

}  // namespace

std::vector<BenchRow> bench_transport(const BenchOptions& options) {
  if (!options.export_folder.empty()) return exported(options);
  std::vector<BenchRow> rows;
  for (const auto add : {add_identity_rows, add_moved_rows, add_candidate_rows, add_growth_rows,
                         add_candidate_skip_rows, add_evaluator_skip_rows, add_changed_lamp_rows, add_turned_head_rows,
                         add_cache_rows, add_error_bar_rows_of_rooms, add_curve_rows})
    add(options, rows);
  return rows;
}

}  // namespace luxrig
