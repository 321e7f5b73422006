#include "tools/bench/nnls/switched.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>

#include "core/solve/emittance.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

constexpr Eigen::Index kPoints = 300, kDimmers = 8;

EmittanceProblem hall(Eigen::Index relays, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  const Eigen::Index lights = relays + kDimmers;
  const auto somewhere = [&] { return Eigen::Vector2d(30 * uniform(random), 20 * uniform(random)); };
  std::vector<Eigen::Vector2d> lamps;
  while (static_cast<Eigen::Index>(lamps.size()) < lights) lamps.push_back(somewhere());
  EmittanceProblem problem;
  problem.lux_per_level.resize(kPoints, lights);
  problem.goal_lx.resize(kPoints);
  problem.max_lx.setConstant(kPoints, std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < kPoints; ++i) {
    const Eigen::Vector2d point = somewhere();
    for (Eigen::Index j = 0; j < lights; ++j)
      problem.lux_per_level(i, j) =
          4000 / std::pow((point - lamps[static_cast<std::size_t>(j)]).squaredNorm() + 16, 1.5);
    problem.goal_lx[i] = 50 + 30 * uniform(random);
    if (i % 10 == 0) problem.max_lx[i] = 90;
  }
  for (Eigen::Index j = 0; j < lights; ++j) problem.switched.push_back(j < relays);
  return problem;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

BenchRow switched_row(Eigen::Index relays, const std::string& method, bool switched, unsigned halls) {
  std::vector<double> errors, seconds;
  unsigned proven = 0;
  int iterations = 0;
  for (unsigned seed = 0; seed < halls; ++seed) {
    EmittanceProblem problem = hall(relays, seed);
    if (!switched) problem.switched.clear();
    const std::clock_t start = std::clock();
    const auto solution = solve_emittance(problem);
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    errors.push_back(solution ? solution->normalised_error : std::nan(""));
    iterations += solution ? solution->iterations : 0;
    proven += solution && solution->switches_proven ? 1 : 0;
  }
  BenchRow row;
  row.case_name = fmt::format("relays-{}", relays);
  row.method = method;
  row.error = median(errors);
  row.seconds = median(seconds);
  row.further = {{"residual_norm", ""},
                 {"in_use", ""},
                 {"rounds", fmt::format("{}", iterations / static_cast<int>(halls))},
                 {"entries", fmt::format("{}", kPoints * (relays + kDimmers))},
                 {"note", fmt::format("{} of {} proven; worst {:.3g} s", proven, halls,
                                      *std::max_element(seconds.begin(), seconds.end()))}};
  say_row_made(row);
  return row;
}

}  // namespace

std::vector<BenchRow> bench_switched(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const Eigen::Index relays : {4, 8, 16, 24, 32}) {
    if (fmt::format("relays-{}", relays).rfind(options.only, 0) != 0) continue;
    const unsigned halls = options.quick ? 3 : 20;
    rows.push_back(switched_row(relays, "branch-and-bound", true, halls));
    rows.push_back(switched_row(relays, "all-dim", false, halls));
  }
  return rows;
}

}  // namespace luxrig
