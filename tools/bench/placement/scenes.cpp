/// Every scene and goal by every method in one run, with the certified bound for Luxrig's number of lights.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/solve/bounds/goal_bounds.h"
#include "tools/bench/placement/rows.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/stop_after.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

struct SceneTarget {
  const char* case_name;
  std::size_t lights;  ///< given; 0 = open
  std::optional<double> max_error, max_seconds;
};
const SceneTarget kSceneTargets[] = {
    {"apartment-known", 8, 0.08, {}},  {"apartment-known", 0, 0.002, 4.0},
    {"office-known", 0, 0.003, 3.0},   {"office-known-global", 0, 0.015, 20.0},
    {"sewers-uniform", 0, 0.073, 5.0}, {"sewers-uniform-global", 0, 0.153, 20.0},
    {"apartment-uniform", 0, {}, {}},  {"apartment-colour", 0, {}, {}},
    {"atrium-uniform", 0, {}, {}},     {"atrium-colour", 0, {}, {}},
    {"cloister-statue", 0, {}, {}},    {"museum-near-surfaces", 0, {}, {}},
    {"studio-two-lights", 2, {}, {}},  {"real-apartment", 0, {}, {}},
    {"real-office", 0, {}, {}},
};
/// In global cases gathered light corrects the result of each method, though only luxrig continues from its own state.
constexpr const char* kOpenMethods[] = {"luxrig", "gp16", "gp16-subplex", "lin2013", "pursuit"};
constexpr const char* kGivenMethods[] = {"luxrig",       "gpk15",   "gpk15-subplex", "gp16",
                                         "gp16-subplex", "lin2013", "annealing",     "pursuit"};

/// The best found and proven by then counts: GP16 takes many minutes to build its tree of 50 000 coloured columns.
constexpr double kSearchSeconds = 60, kBoundSeconds = 60;

/// For at most as many lights. Lights of the search may lie off the candidates; bounds are for the candidates.
double bound_for(const ReadyCase& ready, const Solved& solved, bool quick) {
  CountBoundOptions options;
  options.max_lights = solved.poses.size();
  options.guesses = {{solved.poses.size(), solved.residual}};
  if (quick) {
    options.price_rounds = 3;
    options.nodes_a_round = options.nodes = 50;
  }
  const StopAfter time_up(kBoundSeconds);
  options.watch.stop = time_up.token();
  return goal_error_bounds_by_count(ready.problem().columns, ready.goal(), options).back();
}

}  // namespace

std::vector<BenchRow> bench_placement_scenes(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  PlacementCaseOptions of_case;
  of_case.data_folder = options.data_folder;
  of_case.threads = options.threads;
  for (const SceneTarget& target : kSceneTargets) {
    const std::string name = target.lights > 0 ? fmt::format("scene-{}-{}-lights", target.case_name, target.lights)
                                               : fmt::format("scene-{}", target.case_name);
    if (name.rfind(options.only, 0) != 0) continue;
    const bool first_only = options.quick && &target != kSceneTargets;
    if (first_only && name != options.only) continue;
    auto one = make_placement_case(target.case_name, 1, of_case);
    if (!one) {
      rows.push_back(empty_placement_row(name, "luxrig"));
      set_further(rows.back(), "note", one.error().detail);
      continue;
    }
    const bool global = one->global;
    const auto ready = ReadyCase::make(std::move(*one), options.threads);
    if (!ready) {
      rows.push_back(empty_placement_row(name, "luxrig"));
      set_further(rows.back(), "note", ready.error().detail);
      continue;
    }
    // Returns the number of lights; 0 if left out or refused.
    const auto run = [&](const std::string& row_name, const char* method_name, std::size_t lights) -> std::size_t {
      if (!options.method.empty() && options.method != method_name) return 0;
      const PlacementMethod& method = *find_compared_method(method_name);
      const Solved solved =
          solve_case(**ready, method, {.lights = lights, .threads = options.threads, .max_seconds = kSearchSeconds});
      std::optional<double> bound;
      const bool ours = std::string_view(method_name) == "luxrig";
      if (options.bounds && ours && !global && solved.refused.empty() && solved.error > kRecoveredError)
        bound = bound_for(**ready, solved, options.quick);
      rows.push_back(placement_row(row_name, method_name, **ready, solved, bound));
      if (ours && row_name == name) {
        rows.back().target_error = target.max_error;
        rows.back().target_seconds = target.max_seconds;
      }
      say_row_made(rows.back());
      return solved.poses.size();
    };
    if (target.lights > 0) {
      for (const char* method : kGivenMethods) run(name, method, target.lights);
      continue;
    }
    std::size_t of_luxrig = 0, of_lin = 0;
    for (const char* method : kOpenMethods) {
      const std::size_t lights = run(name, method, 0);
      if (std::string_view(method) == "luxrig") of_luxrig = lights;
      if (std::string_view(method) == "lin2013") of_lin = lights;
    }
    // Different numbers of lights cannot be compared, so run Luxrig with Lin's number, too.
    if (of_luxrig > 0 && of_lin > of_luxrig) run(fmt::format("{}-{}-lights", name, of_lin), "luxrig", of_lin);
  }
  return rows;
}

}  // namespace luxrig
