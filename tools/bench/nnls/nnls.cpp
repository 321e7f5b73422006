/// The solvers behind placement: time and optimality, cold and warm.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

#include "core/solve/least_squares/limited_nnls.h"
#include "core/solve/least_squares/nnls_of_few.h"
#include "tools/bench/nnls/levels.h"
#include "tools/bench/nnls/problems.h"
#include "tools/bench/nnls/switched.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

constexpr double kTargetKkt = 1e-9;

/// Processor time, since the machine may be shared. This runs in one thread.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
double median_seconds(int runs, const Work& work) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    const double start = cpu_seconds();
    work();
    seconds.push_back(cpu_seconds() - start);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

BenchRow nnls_row(const NnlsBenchProblem& one, const std::string& method, double kkt, double seconds,
                  std::optional<double> target_seconds, double residual_norm, std::size_t in_use, int rounds,
                  const std::string& note) {
  BenchRow row;
  row.case_name = one.name;
  row.method = method;
  row.error = kkt;
  row.seconds = seconds;
  row.target_error = kTargetKkt;
  row.target_seconds = target_seconds;
  row.further = {{"residual_norm", fmt::format("{:.17g}", residual_norm)},
                 {"in_use", fmt::format("{}", in_use)},
                 {"rounds", fmt::format("{}", rounds)},
                 {"entries", fmt::format("{}", one.row.size())},
                 {"note", note}};
  say_row_made(row);
  return row;
}

std::size_t in_use(const Eigen::VectorXd& x) { return static_cast<std::size_t>((x.array() > 0).count()); }

void add_whole(const NnlsBenchProblem& one, int runs, bool slow, std::vector<BenchRow>& rows) {
  const NnlsProblem problem = one.problem();
  NnlsSolution solution;
  const double cold = median_seconds(runs, [&] { solution = *solve_nnls(problem); });
  rows.push_back(nnls_row(one, "nnls", solution.kkt.worst(), cold, {}, solution.residual_norm, in_use(solution.x),
                          solution.iterations, "checking the input included"));
  if (slow) {
    NnlsOptions single;
    single.max_entering = 1;
    NnlsSolution other;
    const double seconds = median_seconds(1, [&] { other = *solve_nnls(problem, single); });
    rows.push_back(nnls_row(one, "one-at-a-time", other.kkt.worst(), seconds, {}, other.residual_norm, in_use(other.x),
                            other.iterations, "as Lawson & Hanson enter columns"));
  }
  // A column in use is forbidden, another is allowed again: as a cut or a mutation over all candidates does.
  auto solver = NnlsSolver::make(problem);
  if (!solver) return;
  const Eigen::VectorXd first = solver->solve().x;
  std::vector<Eigen::Index> used;
  for (Eigen::Index j = 0; j < first.size(); ++j)
    if (first[j] > 0) used.push_back(j);
  if (used.empty()) return;
  double worst = 0;
  std::size_t next = 0;
  NnlsSolution warm;
  const double seconds = median_seconds(2 * runs + 5, [&] {
    solver->allow(used[next % used.size()], true);
    next += 7;
    solver->allow(used[next % used.size()], false);
    warm = solver->solve();
    worst = std::max(worst, warm.kkt.worst());
  });
  rows.push_back(nnls_row(one, "one-forbidden", worst, seconds, {}, warm.residual_norm, in_use(warm.x), warm.iterations,
                          "warm: another of the columns in use is forbidden"));
}

void add_exchanges(const NnlsBenchProblem& one, std::size_t lights, int exchanges, double target_seconds,
                   std::vector<BenchRow>& rows) {
  const auto problem = share_problem(one.problem());
  if (!problem) return;
  NnlsOfFew few(*problem);
  std::mt19937_64 random(3);
  std::vector<Eigen::Index> chosen;
  const auto any = [&] { return static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(one.columns())); };
  while (chosen.size() < lights) chosen.push_back(any());
  few.choose(chosen);
  double worst = 0, best = few.residual_norm();
  const int batch = exchanges / 10;
  const double seconds = median_seconds(10,
                                        [&] {
                                          for (int k = 0; k < batch; ++k) {
                                            few.exchange(random() % lights, any());
                                            best = std::min(best, few.residual_norm());
                                          }
                                        }) /
                         batch;
  for (int k = 0; k < 200; ++k) {
    few.exchange(random() % lights, any());
    worst = std::max(worst, few.kkt().worst());
  }
  rows.push_back(nnls_row(one, fmt::format("exchange-of-{}", lights), worst, seconds, target_seconds, best, lights, 0,
                          fmt::format("{:.2f} us an exchange", 1e6 * seconds)));
}

void add_limited(const NnlsBenchProblem& one, int runs, std::vector<BenchRow>& rows) {
  const NnlsProblem problem = one.problem();
  const NnlsSolution free = *solve_nnls(problem);
  const Eigen::VectorXd lux = problem.goal - free.residual;
  const Eigen::Index points = (one.rows + 9) / 10;
  LinearLimits limits;
  limits.most = Eigen::VectorXd::Constant(points + 1, 0.9 * lux.maxCoeff());
  limits.most[points] = 0.95 * free.x.sum();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd column(one.rows);
  for (Eigen::Index j = 0; j < one.columns(); ++j) {
    column.setZero();
    problem.columns.add(j, 1.0, column.data());
    for (Eigen::Index k = 0; k < points; ++k)
      if (column[10 * k] != 0) entries.emplace_back(k, j, column[10 * k]);
    entries.emplace_back(points, j, 1.0);  // power
  }
  limits.rows.resize(points + 1, one.columns());
  limits.rows.setFromTriplets(entries.begin(), entries.end());
  LimitedNnlsSolution solution;
  const double seconds = median_seconds(runs, [&] { solution = *solve_limited_nnls(problem, limits); });
  const auto binding = (solution.multiplier.array() > 0).count();
  rows.push_back(nnls_row(
      one, "limited", solution.least_squares.kkt.worst(), seconds, {}, solution.least_squares.residual_norm,
      in_use(solution.least_squares.x), solution.least_squares.iterations,
      fmt::format("{} limits; {} bind; {} rounds of multipliers", limits.most.size(), binding, solution.rounds)));
}

}  // namespace

std::vector<BenchRow> bench_nnls(const BenchOptions& options) {
  struct Case {
    NnlsBenchProblem (*make)(Eigen::Index, Eigen::Index, double);
    Eigen::Index rows, columns;
    double share;
    double exchange_seconds;
    const char* name;
  };
  constexpr Case kCases[] = {{random_nnls, 300, 2'000, 0.6, 10e-6, "random-300x2000"},
                             {random_nnls, 300, 20'000, 0.1, 5e-6, "random-300x20000"},
                             {random_nnls, 3'000, 20'000, 0.1, 25e-6, "random-3000x20000"},
                             {lamps_nnls, 300, 2'000, 0.6, 10e-6, "lamps-300x2000"},
                             {lamps_nnls, 300, 20'000, 0.1, 5e-6, "lamps-300x20000"},
                             {lamps_nnls, 3'000, 20'000, 0.1, 25e-6, "lamps-3000x20000"}};
  std::vector<BenchRow> rows;
  std::error_code ignored;  // a failed write is reported below
  if (!options.export_folder.empty()) std::filesystem::create_directories(options.export_folder, ignored);
  for (const Case& one : kCases) {
    if (std::string(one.name).rfind(options.only, 0) != 0) continue;
    const bool large = one.rows > 1000;
    const NnlsBenchProblem problem = one.make(one.rows, one.columns, one.share);
    if (!options.export_folder.empty() && !write_nnls(problem, options.export_folder / (problem.name + ".nnls")))
      fmt::print(stderr, "{}: cannot be written\n", (options.export_folder / problem.name).string());
    add_whole(problem, options.quick ? 1 : 5, !large && !options.quick, rows);
    add_exchanges(problem, 10, options.quick ? 2'000 : 20'000, one.exchange_seconds, rows);
    if (!large) add_limited(problem, options.quick ? 1 : 3, rows);
  }
  for (BenchRow& row : bench_levels(options)) rows.push_back(std::move(row));
  for (BenchRow& row : bench_switched(options)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace luxrig
