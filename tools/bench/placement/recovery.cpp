/// Known lights found again over many seeds. Each seed furnishes the rooms and hangs the lamps differently.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/bench/placement/rows.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

struct RecoverySuite {
  const char* case_name;
  bool number_given;
  std::optional<double> max_error, max_seconds;  ///< wanted of nine in ten
};
constexpr RecoverySuite kRecoveries[] = {
    {"apartment-known", true, 0.002, 2}, {"apartment-known", false, 0.002, 4}, {"office-known", true, 0.003, 3},
    {"office-known", false, 0.003, 3},   {"sewers-known", true, {}, {}},       {"cloister-known", true, {}, {}},
    {"museum-known", true, {}, {}},      {"studio-known", true, {}, {}},       {"atrium-known", true, {}, {}}};

/// The value that this share of them does not exceed.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = std::ceil(share * static_cast<double>(values.size())) - 1;
  return values[static_cast<std::size_t>(std::max(0.0, at))];
}

}  // namespace

std::vector<BenchRow> bench_placement_recovery(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  const PlacementMethod& luxrig = *find_compared_method("luxrig");
  for (const RecoverySuite& suite : kRecoveries) {
    const std::string name = fmt::format("{}-{}", suite.case_name, suite.number_given ? "given" : "open");
    if (name.rfind(options.only, 0) != 0) continue;
    if (options.quick && name != options.only && !suite.max_error) continue;
    const int seeds = options.quick ? 3 : options.seeds.value_or(100);
    std::vector<double> errors, walls, cpus, places_m, fluxes;
    double found = 0;
    for (int seed = options.first_seed; seed < options.first_seed + seeds; ++seed) {
      const auto key = static_cast<std::uint64_t>(seed);
      const auto ready = ReadyCase::make(*make_placement_case(suite.case_name, key), options.threads);
      const PlacementCase& one = (*ready)->of();
      const Solved solved = solve_case(
          **ready, luxrig,
          {.lights = suite.number_given ? one.known_lumens.size() : 0, .seed = key, .threads = options.threads});
      const Recovery recovery = recovery_of(one, solved);
      rows.push_back(placement_row(fmt::format("{}-{}", name, seed), luxrig.name, **ready, solved));
      say_row_made(rows.back());
      errors.push_back(solved.error);
      walls.push_back(solved.seconds.wall);
      cpus.push_back(solved.seconds.cpu);
      places_m.push_back(recovery.farthest_m);
      fluxes.push_back(recovery.worst_flux);
      if (recovery.found(solved.error)) ++found;
    }
    for (const double share : {0.5, 0.9, 1.0}) {
      BenchRow row = empty_placement_row(fmt::format("{}-{:.0f}%", name, 100 * share), luxrig.name);
      row.error = quantile(errors, share);
      row.seconds = quantile(walls, share);
      set_further(row, "cpu_seconds", fmt::format("{:.3g}", quantile(cpus, share)));
      set_further(row, "found", fmt::format("{:.3g}", found / seeds));
      set_further(row, "farthest_m", fmt::format("{:.3g}", quantile(places_m, share)));
      set_further(row, "worst_flux", fmt::format("{:.3g}", quantile(fluxes, share)));
      if (share == 0.9) {
        row.target_error = suite.max_error;
        row.target_seconds = suite.max_seconds;
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace luxrig
