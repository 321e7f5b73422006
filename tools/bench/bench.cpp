#include "tools/bench/bench.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "tools/bench/report.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"
#include "tools/process/files.h"

namespace luxrig {
namespace {

struct Suite {
  const char* name;
  const char* summary;
  std::vector<BenchRow> (*run)(const BenchOptions& options);
};
constexpr Suite kSuites[] = {
    {"analytic", "evaluators against closed forms: sources, flux, enclosures, furnace, CIE 171", bench_analytic},
    {"transport", "evaluators in furnished rooms against converged path tracing", bench_transport},
    {"nnls", "non-negative least squares: cold, warm, one column exchanged, under limits", bench_nnls},
    {"placement", "known lights found again; every scene by every method, with bounds", bench_placement},
    {"highlight", "an object's relief: shadow edges; lights by every method; their number; stability", bench_highlight},
    {"goals", "painting light on surfaces: patches and groups of up to 1e7 triangles, strokes on 1e6", bench_goals},
    {"buses", "output cycle under a solve; loads: 247 Modbus units, 64 universes, 64 axes", bench_buses},
    {"loop", "a rig whose truth is not its file's: calibrated, then held", bench_loop},
    {"hold", "a held show: faults that no device reports, quiet hours, lamps that light each other's meters",
     bench_hold},
    {"heads", "pan-tilt heads that hang otherwise than stated, calibrated by a camera", bench_heads},
    {"faults", "faults of every bus by the hundred: what the light did, when it was said and over", bench_faults},
};

/// The command that prints these rows again.
std::string command_of(const Suite& suite, const BenchOptions& options) {
  const BenchOptions usual;
  std::string text = fmt::format("luxrig bench {}", suite.name);
  if (options.quick) text += " --quick";
  if (!options.only.empty()) text += " --only " + options.only;
  if (!options.method.empty()) text += " --method " + options.method;
  if (options.reference_error != usual.reference_error)
    text += fmt::format(" --reference-error {:g}", options.reference_error);
  for (const auto& rig : options.rigs) text += " --rig " + rig.string();
  if (options.seeds) text += fmt::format(" --seeds {}", *options.seeds);
  if (options.first_seed != usual.first_seed) text += fmt::format(" --first-seed {}", options.first_seed);
  if (!options.bounds) text += " --no-bounds";
  if (options.seconds) text += fmt::format(" --seconds {:g}", *options.seconds);
  if (options.threads != usual.threads) text += fmt::format(" --threads {}", options.threads);
  if (!options.data_folder.empty()) text += " --data DIR";
  return text;
}

std::optional<std::string> report(const Suite& suite, const std::vector<BenchRow>& rows, const BenchOptions& options) {
  const auto& file = options.report_file;
  std::string before;
  if (std::error_code error; std::filesystem::exists(file, error)) {
    const auto text = read_file(file);
    if (!text) return text.error().front().text();
    before = *text;
  }
  const auto written = write_file(file, with_rows(before, suite.name, command_of(suite, options), rows, provenance()));
  if (!written)
    return fmt::format("{}:0:0: {}: name a file in a folder that exists", file.string(), written.error().detail);
  return std::nullopt;
}

int finish(const Suite& suite, const std::vector<BenchRow>& rows, const BenchOptions& options) {
  end_row_progress();
  fmt::print("{}", table_of(rows));
  int code = 0;
  for (const BenchRow& row : rows)
    if (row.met() == std::optional(false)) code = 1;
  if (!options.csv_file.empty()) {
    std::ofstream out(options.csv_file, std::ios::binary);
    out << csv_of(rows);
    out.close();
    if (!out) {
      fmt::print(stderr, "{}:0:0: cannot be written: name a file in a folder that exists\n", options.csv_file.string());
      code = 1;
    }
  }
  if (!options.report_file.empty()) {
    if (const auto trouble = report(suite, rows, options)) {
      fmt::print(stderr, "{}\n", *trouble);
      code = 1;
    }
  }
  if (!options.plot_file.empty()) {
    if (const std::string trouble = write_plot(rows, suite.name, options.plot_file); !trouble.empty()) {
      fmt::print(stderr, "{}:0:0: {}: name a file in a folder that exists\n", options.plot_file.string(), trouble);
      code = 1;
    }
  }
  return code;
}

}  // namespace

std::vector<std::string> bench_suites() {
  std::vector<std::string> names;
  for (const Suite& suite : kSuites) names.emplace_back(suite.name);
  return names;
}

int run_bench(const std::string& suite, const BenchOptions& options) {
  for (const Suite& known : kSuites) {
    if (suite != known.name) continue;
    keep_rows_in(options.csv_file);
    return finish(known, known.run(options), options);
  }
  fmt::print(stderr, "no bench suite is called \"{}\"; there are:\n", suite);
  for (const Suite& known : kSuites) fmt::print(stderr, "  {:<12}{}\n", known.name, known.summary);
  return 2;
}

}  // namespace luxrig
