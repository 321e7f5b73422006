#include "tools/bench/nnls_levels.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "core/solve/emittance.h"
#include "core/transport/rig_transport.h"
#include "tools/bench/aisles_rig.h"
#include "tools/bench/row_progress.h"
#include "tools/luxrig/session.h"

namespace luxrig {
namespace {

using Eigen::Index;

constexpr int kWorks = 500;

EmittanceProblem problem_of(const Rig& rig, const Eigen::MatrixXd& lux_per_level) {
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

BenchRow row_of(const std::string& name, const std::string& method, const EmittanceProblem& problem) {
  const std::clock_t start = std::clock();
  const auto solution = solve_emittance(problem);
  BenchRow row;
  row.case_name = name;
  row.method = method;
  row.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  row.error = solution ? solution->kkt_residual : std::nan("");
  row.target_error = 1e-9;
  row.target_seconds = 1;
  row.further = {{"residual_norm", solution ? fmt::format("{:.17g}", solution->normalised_error) : ""},
                 {"in_use", solution ? fmt::format("{}", (solution->level.array() > 0).count()) : ""},
                 {"rounds", solution ? fmt::format("{}", solution->iterations) : ""},
                 {"entries", fmt::format("{}", (problem.lux_per_level.array() > 0).count())},
                 {"note", "levels under limits, and the reason for each goal missed; residual_norm is of the goal"}};
  say_row_made(row);
  return row;
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
    std::error_code ignored;  // what cannot be written cannot be opened below
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
    rows.push_back(row_of(name, "direct", problem));
    // What a work has from lamps afar is a little of each, more from those near by.
    for (Index j = 0; j < problem.lux_per_level.cols(); ++j)
      for (Index i = 0; i < problem.lux_per_level.rows(); ++i)
        problem.lux_per_level(i, j) +=
            0.02 * (1 + 0.1 * std::sin(static_cast<double>(7 * i + 13 * j))) /
            (1 + 0.01 * std::pow(static_cast<double>(i) - static_cast<double>(j) * kWorks / spots, 2));
    rows.push_back(row_of(name, "reflections", problem));
  }
  return rows;
}

}  // namespace luxrig
