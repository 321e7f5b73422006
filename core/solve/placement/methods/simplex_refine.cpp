#include "core/solve/placement/methods/simplex_refine.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/check.h"

namespace luxrig {
namespace {

/// Size of the first simplex, as a share of the way to the bounds.
constexpr double kFirstStep = 0.5;
/// A level rises by at most this many times its start.
constexpr double kMaxRise = 3;

struct SimplexProblem {
  Eigen::VectorXd lower, upper;  ///< of unknowns that start at 0
  std::function<double(const Eigen::VectorXd&)> error;
  std::function<bool()> ended;
};

struct SimplexCall {
  const SimplexProblem* problem;
  nlopt_opt solver;
};

double simplex_error(unsigned count, const double* unknowns, double*, void* data) {
  const auto& call = *static_cast<const SimplexCall*>(data);
  const double error = call.problem->error(Eigen::Map<const Eigen::VectorXd>(unknowns, count));
  if (call.problem->ended()) nlopt_force_stop(call.solver);
  return error;
}

/// The problem keeps the best result: NLopt's own answer is not needed.
void run_simplex(const SimplexProblem& problem, const SimplexOptions& options) {
  const auto count = static_cast<unsigned>(problem.lower.size());
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> solver(
      nlopt_create(options.subplex ? NLOPT_LN_SBPLX : NLOPT_LN_NELDERMEAD, count), nlopt_destroy);
  LUXRIG_CHECK(solver != nullptr, "no simplex of {} unknowns", count);
  SimplexCall call{&problem, solver.get()};
  Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(count);
  // Downwards if there is no way up; NLopt leaves out unknowns that can go neither way, but needs a step.
  Eigen::VectorXd first_step(count);
  for (Eigen::Index i = 0; i < first_step.size(); ++i) {
    const double up = std::min(1.0, problem.upper[i]), down = std::min(1.0, -problem.lower[i]);
    first_step[i] = kFirstStep * (up > 0 ? up : down > 0 ? -down : 1);
  }
  nlopt_set_min_objective(solver.get(), simplex_error, &call);
  nlopt_set_lower_bounds(solver.get(), problem.lower.data());
  nlopt_set_upper_bounds(solver.get(), problem.upper.data());
  nlopt_set_initial_step(solver.get(), first_step.data());
  nlopt_set_stopval(solver.get(), options.wanted_error);
  nlopt_set_ftol_rel(solver.get(), options.min_change);
  nlopt_set_maxeval(solver.get(), options.max_evaluations_per_unknown * static_cast<int>(count));
  double error = 0;
  nlopt_optimize(solver.get(), unknowns.data(), &error);
}

/// Bounds of the unknowns that move and turn one light.
Eigen::VectorXd bounds_of_pose(Eigen::Index freedoms, const SimplexOptions& options) {
  Eigen::VectorXd bounds = Eigen::VectorXd::Constant(freedoms, options.turn_rad);
  bounds.head<3>().setConstant(options.cell_m);
  return bounds;
}

}  // namespace

std::size_t refine_by_simplex(PlacedLights& lights, const SimplexOptions& options) {
  if (lights.size() == 0 || lights.error() <= options.wanted_error) return 0;
  const PlacedLights start = lights;
  const Eigen::Index freedoms = start.freedoms(), count = static_cast<Eigen::Index>(start.size());
  std::size_t columns = 0;
  std::vector<LightPose> poses = start.poses();
  SimplexProblem problem;
  problem.upper = bounds_of_pose(freedoms, options).replicate(count, 1);
  problem.lower = -problem.upper;
  problem.ended = [&] { return options.stop.stop_requested() || columns >= options.max_columns; };
  problem.error = [&](const Eigen::VectorXd& unknowns) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto of = unknowns.segment(k * freedoms, freedoms);
      const auto light = static_cast<std::size_t>(k);
      poses[light] = of.isZero(0) ? start.poses()[light] : moved(start.poses()[light], of);
      columns += poses[light] == start.poses()[light] ? 0 : 1;
    }
    PlacedLights there = start;
    there.move(poses);
    const double error = there.error();
    if (error < lights.error()) {
      lights = std::move(there);
      if (options.better) options.better({error, lights.poses(), lights.levels(), columns});
    }
    return error;
  };
  run_simplex(problem, options);
  return columns;
}

std::size_t refine_with_levels_by_simplex(PlacedLights& lights, const MovableLight& light, const LightingGoal& goal,
                                          const SimplexOptions& options) {
  if (lights.size() == 0 || lights.error() <= options.wanted_error) return 0;
  const PlacedLights start = lights;
  const Eigen::Index freedoms = start.freedoms(), emitters = start.emitters();
  const Eigen::Index of_light = freedoms + emitters, count = static_cast<Eigen::Index>(start.size());
  const double largest_level = start.levels().maxCoeff();
  std::size_t columns = 0;
  SimplexProblem problem;
  problem.upper.resize(of_light * count);
  problem.lower.resize(of_light * count);
  Eigen::VectorXd scale(start.levels().size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = k * of_light;
    problem.upper.segment(at, freedoms) = bounds_of_pose(freedoms, options);
    problem.lower.segment(at, freedoms) = -problem.upper.segment(at, freedoms);
    for (Eigen::Index e = 0; e < emitters; ++e) {
      const double level = start.levels()[k * emitters + e];
      // A light that starts dark is measured by the brightest.
      double& unit = scale[k * emitters + e] = level > 0 ? level : largest_level > 0 ? largest_level : 1;
      problem.lower[at + freedoms + e] = -level / unit;
      problem.upper[at + freedoms + e] = std::clamp((goal.max_level - level) / unit, 0.0, kMaxRise);
    }
  }
  const Eigen::VectorXd wanted = goal.weighted();
  const double goal_norm = goal.weighted(goal.lux).norm();
  std::vector<LightPose> best_poses = start.poses();
  double best = start.error();
  Eigen::VectorXd lux;
  problem.ended = [&] { return options.stop.stop_requested() || columns >= options.max_columns; };
  problem.error = [&](const Eigen::VectorXd& unknowns) {
    std::vector<LightPose> poses = start.poses();
    Eigen::VectorXd rest = wanted, levels = start.levels();
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto of = unknowns.segment(k * of_light, freedoms);
      auto level = levels.segment(k * emitters, emitters);
      level += scale.segment(k * emitters, emitters).cwiseProduct(unknowns.segment(k * of_light + freedoms, emitters));
      const auto i = static_cast<std::size_t>(k);
      bool hangs = false;
      if (!of.isZero(0)) {
        ++columns;
        const LightPose pose = moved(start.poses()[i], of);
        hangs = light.column(pose, lux, nullptr);
        if (hangs) poses[i] = pose;
      }
      if (hangs)
        rest -= goal.weighted_columns(lux) * level;
      else
        rest -= start.columns().middleCols(k * emitters, emitters) * level;
    }
    const double norm = rest.norm(), error = goal_norm > 0 ? norm / goal_norm : norm;
    if (error < best) {
      best = error;
      best_poses = std::move(poses);
      if (options.better) options.better({error, best_poses, levels, columns});
    }
    return error;
  };
  run_simplex(problem, options);
  lights = start;
  lights.move(best_poses);
  columns += lights.size();
  return columns;
}

}  // namespace luxrig
