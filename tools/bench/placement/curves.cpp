/// Error against time: the best error up to each time, over seeds. By name only (`--only curve`).

#include <fmt/format.h>

#include <algorithm>

#include "tools/bench/placement/rows.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

struct CurveCase {
  const char* name;
  std::size_t lights;  ///< 0 = the number of known lights
};
constexpr CurveCase kCurveCases[] = {{"apartment-known", 0},    {"office-known", 0},     {"sewers-uniform", 11},
                                     {"apartment-uniform", 15}, {"cloister-statue", 14}, {"museum-near-surfaces", 15},
                                     {"studio-two-lights", 2},  {"atrium-uniform", 17}};
constexpr const char* kCurveMethods[] = {"luxrig", "gpk15", "gpk15-subplex", "gp16-subplex", "lin2013", "annealing"};
constexpr double kTimes_s[] = {0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10};
constexpr double kMinDrawn = 1e-6;  ///< the plot's axis is logarithmic

double error_at(const Solved& solved, double ready_s, double at_s) {
  double error = 1;
  for (const BetterAt& better : solved.curve)
    if (ready_s + better.seconds <= at_s) error = std::min(error, better.error);
  return error;
}

}  // namespace

std::vector<BenchRow> bench_placement_curves(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  if (options.only.rfind("curve", 0) != 0) return rows;
  const int seeds = options.quick ? 2 : options.seeds.value_or(20);
  for (const CurveCase& curve : kCurveCases) {
    const std::string name = fmt::format("curve-{}", curve.name);
    if (name.rfind(options.only, 0) != 0) continue;
    std::vector<std::vector<Solved>> solved(std::size(kCurveMethods));
    double ready_s = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto key = static_cast<std::uint64_t>(seed);
      const auto ready = ReadyCase::make(*make_placement_case(curve.name, key), options.threads);
      ready_s = (*ready)->seconds().wall;
      const std::size_t lights = curve.lights > 0 ? curve.lights : (*ready)->of().known_lumens.size();
      for (std::size_t m = 0; m < std::size(kCurveMethods); ++m) {
        solved[m].push_back(solve_case(**ready, *find_compared_method(kCurveMethods[m]),
                                       {.lights = lights,
                                        .seed = key,
                                        .threads = options.threads,
                                        .max_seconds = kTimes_s[std::size(kTimes_s) - 1]}));
        say_row_made(name, kCurveMethods[m]);
      }
    }
    for (std::size_t m = 0; m < std::size(kCurveMethods); ++m)
      for (const double at_s : kTimes_s) {
        std::vector<double> errors;
        for (const Solved& of : solved[m]) errors.push_back(error_at(of, ready_s, at_s));
        std::sort(errors.begin(), errors.end());
        const auto quartile = [&](double share) {
          return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1) + 0.5)];
        };
        BenchRow row = empty_placement_row(name, kCurveMethods[m]);
        row.error = std::max(kMinDrawn, quartile(0.5));
        row.seconds = at_s;
        row.quartiles = {std::max(kMinDrawn, quartile(0.25)), std::max(kMinDrawn, quartile(0.75))};
        set_further(row, "note", fmt::format("quartiles {:.3g} to {:.3g}", quartile(0.25), quartile(0.75)));
        say_row_made(row);
        rows.push_back(std::move(row));
      }
  }
  return rows;
}

}  // namespace luxrig
