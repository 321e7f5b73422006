/// Highlighting of objects: the parts of the suite, each in its own file.

#include <fmt/format.h>

#include <cmath>

#include "tools/bench/highlight/rows.h"
#include "tools/bench/suites.h"

namespace luxrig {

std::vector<BenchRow> bench_highlight(const BenchOptions& options) {
  if (!options.export_folder.empty()) return export_highlight_objects(options.export_folder);
  std::vector<BenchRow> rows;
  std::vector<std::string> missing;
  for (HighlightObject& object : highlight_objects(options, missing))
    for (auto part : {add_curvature_rows, add_edge_rows, add_light_rows, add_number_rows, add_stable_rows, add_aim_rows,
                      add_seen_rows, add_mounted_rows, add_mounted_number_rows})
      part(object, options, rows);
  add_cluster_rows(options, rows);
  for (std::string& reason : missing) {
    HighlightRow row{"object-file", "", std::nan(""), {}, {}, {}, {}, {}, std::move(reason)};
    for (char& c : row.note)
      if (c == ',' || c == '\n') c = ';';
    rows.push_back(bench_row_of(row));
  }
  return rows;
}

}  // namespace luxrig
