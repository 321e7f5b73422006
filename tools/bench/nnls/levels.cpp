#include "tools/bench/nnls/levels.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>

#include "core/solve/emittance.h"
#include "core/solve/least_squares/limited_methods.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/session.h"
#include "tools/bench/aisles_rig.h"
#include "tools/bench/row_progress.h"
#include "tools/luxrig/open_session.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kWorks = 500;
constexpr double kTieOfLevels = 1e-5;

EmittanceProblem problem_of(const Rig& rig, const MatrixXd& lux_per_level) {
  EmittanceProblem problem;
  problem.lux_per_level = lux_per_level;
  const auto points = static_cast<Index>(rig.points.size());
  problem.goal_lx.resize(points);
  problem.max_lx.resize(points);
  for (Index i = 0; i < points; ++i) {
    const Point& point = rig.points[static_cast<std::size_t>(i)];
    problem.goal_lx[i] = point.goal_lx.value_or(std::nan(""));
    problem.max_lx[i] = point.max_lx.value_or(HUGE_VAL);
  }
  return problem;
}

/// As in solve_emittance(): columns, rows and goal of norm 1, and the tie term. All points have a goal.
LimitedLeastSquares least_squares_of(const EmittanceProblem& problem) {
  const MatrixXd& lux = problem.lux_per_level;
  const Index lights = lux.cols();
  LimitedLeastSquares p;
  p.E = MatrixXd::Zero(kWorks + lights, lights);
  p.f = VectorXd::Zero(kWorks + lights);
  p.f.head(kWorks) = problem.goal_lx.normalized();
  const VectorXd norm = lux.colwise().norm().cwiseMax(1e-6), unit = norm / problem.goal_lx.norm();
  p.E.topRows(kWorks) = lux * norm.cwiseInverse().asDiagonal();
  p.E.bottomRows(lights) = kTieOfLevels * MatrixXd::Identity(lights, lights);
  p.upper = unit;
  std::vector<Index> limited;
  for (Index i = 0; i < kWorks; ++i)
    if (std::isfinite(problem.max_lx[i])) limited.push_back(i);
  p.G = lux(limited, Eigen::all) * unit.cwiseInverse().asDiagonal();
  const VectorXd length = p.G.rowwise().norm().cwiseMax(1e-6);
  p.G = length.cwiseInverse().asDiagonal() * p.G;
  p.slack = problem.max_lx(limited).cwiseQuotient(length);
  return p;
}

BenchRow levels_row(const std::string& name, const std::string& method, double seconds, double kkt,
                    double residual_norm, Index in_use, int rounds, Index entries, const std::string& note) {
  BenchRow row;
  row.case_name = name;
  row.method = method;
  row.seconds = seconds;
  row.error = kkt;
  row.target_error = 1e-9;
  row.further = {{"residual_norm", fmt::format("{:.17g}", residual_norm)},
                 {"in_use", fmt::format("{}", in_use)},
                 {"rounds", fmt::format("{}", rounds)},
                 {"entries", fmt::format("{}", entries)},
                 {"note", note}};
  return row;
}

template <class Work>
double processor_seconds(const Work& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

BenchRow levels_row(const std::string& name, const std::string& method, double seconds, const LimitedLeastSquares& p,
                    const LimitedLeastSquaresResult& at, const std::string& note) {
  const VectorXd gradient = p.E.transpose() * (p.E * at.z - p.f);
  return levels_row(name, method, seconds, kkt_violation(p, at, row_multipliers(p.G, at, gradient)),
                    (p.E * at.z - p.f).norm(), (at.z.array() > 0).count(), at.iterations, (p.E.array() != 0).count(),
                    note);
}

void add_rows_of_solvers(const std::string& name, const EmittanceProblem& problem, bool quick,
                         std::vector<BenchRow>& rows) {
  const LimitedLeastSquares p = least_squares_of(problem);
  std::optional<LimitedLeastSquaresResult> many;
  const double many_seconds = processor_seconds([&] { many = solve_by_multipliers(p, {}); });
  if (many) {
    rows.push_back(levels_row(name, "many-at-a-time", many_seconds, p, *many,
                              fmt::format("{} limits, {} bind", p.G.rows(), many->working_rows.size())));
    rows.back().target_seconds = 1;
    say_row_made(rows.back());
  }
  if (!quick) {
    LimitedLeastSquaresResult one;
    const double one_seconds = processor_seconds([&] { one = solve_by_active_set(p, {}); });
    rows.push_back(levels_row(name, "one-at-a-time", one_seconds, p, one,
                              fmt::format("{:.0f} times as long", one_seconds / many_seconds)));
    say_row_made(rows.back());
  }
  std::optional<EmittanceSolution> solution;
  const double seconds = processor_seconds([&] {
    if (auto solved = solve_emittance(problem)) solution = std::move(*solved);
  });
  if (!solution) return;
  rows.push_back(levels_row(name, "with-reasons", seconds, solution->kkt_residual, solution->normalised_error,
                            (solution->level.array() > 0).count(), solution->iterations,
                            (problem.lux_per_level.array() > 0).count(), "residual_norm is of the goal"));
  rows.back().target_seconds = 1;
  say_row_made(rows.back());
}

}  // namespace

std::vector<BenchRow> bench_levels(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const int spots : {250, 500, 1000}) {
    const std::string name = fmt::format("levels-{}x{}", spots, kWorks);
    if (name.rfind(options.only, 0) != 0) continue;
    const bool keep = !options.export_folder.empty();
    const std::filesystem::path folder =
        (keep ? options.export_folder : std::filesystem::temp_directory_path() / fmt::format("luxrig-{}", getpid())) /
        name;
    std::error_code ignored;  // an unwritten file cannot be opened below
    std::filesystem::create_directories(folder, ignored);
    std::ofstream(folder / "rig.toml") << aisles_rig_text(spots, kWorks);
    const auto session = open_session(folder);
    if (!keep) std::filesystem::remove_all(folder.parent_path(), ignored);
    if (!session) {
      fmt::print(stderr, "{}: {}\n", name, session.error().front().text());
      continue;
    }
    ComputeOptions compute;
    compute.model = Model::direct;
    compute.threads = options.threads;
    const auto transport = compute_transport(*session, compute);
    if (!transport) continue;
    EmittanceProblem problem =
        problem_of(session->rig, transport->lux_per_level.topRows(static_cast<Index>(session->rig.points.size())));
    add_rows_of_solvers(name, problem, options.quick, rows);
    // Reflected light: a little from every lamp, more from nearby lamps.
    for (Index j = 0; j < problem.lux_per_level.cols(); ++j)
      for (Index i = 0; i < problem.lux_per_level.rows(); ++i)
        problem.lux_per_level(i, j) +=
            0.02 * (1 + 0.1 * std::sin(static_cast<double>(7 * i + 13 * j))) /
            (1 + 0.01 * std::pow(static_cast<double>(i) - static_cast<double>(j) * kWorks / spots, 2));
    add_rows_of_solvers(name + "-reflections", problem, options.quick, rows);
  }
  return rows;
}

}  // namespace luxrig
