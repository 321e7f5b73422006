#include "tools/luxrig/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/rig/rig_file.h"
#include "core/scene/scene_builder.h"
#include "core/solve/emittance.h"
#include "core/transport/cache/radiance_cache.h"
#include "core/transport/evaluator_choice.h"
#include "core/transport/rig_transport.h"
#include "drivers/registry.h"

namespace luxrig {
namespace {

using Steady = std::chrono::steady_clock;

double seconds_since(Steady::time_point start) { return std::chrono::duration<double>(Steady::now() - start).count(); }

EmittanceProblem problem_of(const Rig& rig, const TransportMatrix& transport) {
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  const auto lights = static_cast<Eigen::Index>(rig.fixtures.size());
  EmittanceProblem problem;
  problem.lux_per_level = transport.lux_per_level.topLeftCorner(points, lights);
  problem.fixed_lx = daylight_lux(rig, transport).head(points);
  problem.goal_lx.setConstant(points, std::numeric_limits<double>::quiet_NaN());
  problem.weight.setOnes(points);
  problem.max_lx.setConstant(points, std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < points; ++i) {
    const Point& point = rig.points[static_cast<std::size_t>(i)];
    if (point.goal_lx) problem.goal_lx[i] = *point.goal_lx;
    if (point.max_lx) problem.max_lx[i] = *point.max_lx;
    problem.weight[i] = point.weight;
  }
  problem.max_level.resize(lights);
  for (Eigen::Index j = 0; j < lights; ++j) {
    problem.max_level[j] = std::min(rig.fixtures[static_cast<std::size_t>(j)].max_level, rig.limits.max_level);
  }
  return problem;
}

/// Limits that daylight alone breaks; empty when there are none.
std::string broken_by_daylight(const Rig& rig, const EmittanceProblem& problem) {
  std::string broken;
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const double fixed_lx = problem.fixed_lx[static_cast<Eigen::Index>(i)];
    if (!rig.points[i].max_lx || fixed_lx <= *rig.points[i].max_lx) continue;
    broken += fmt::format("{}point \"{}\" has {:.4g} lx of daylight alone, its limit is {:.4g} lx",
                          broken.empty() ? "" : "; ", rig.points[i].name, fixed_lx, *rig.points[i].max_lx);
  }
  if (!broken.empty()) broken += ": shade the opening, move the point or raise its max_lx";
  return broken;
}

PlannedLight planned_light(const Rig& rig, const Fixture& fixture, double level) {
  const Luminaire& luminaire = rig.luminaires[fixture.luminaire];
  PlannedLight light;
  light.name = fixture.name;
  light.luminaire = luminaire.name;
  light.position_world_m = fixture.world_from_mount.translation_m;
  light.aim_world_m = fixture.aim_world_m;
  light.pan_deg = deg_from_rad(fixture.joints.pan_rad);
  light.tilt_deg = deg_from_rad(fixture.joints.tilt_rad);
  light.level = level;
  light.lumens = level * luminaire.lumens;
  return light;
}

}  // namespace

Checked<Session> open_session(const std::filesystem::path& rig_path) {
  auto rig = load_rig(rig_path);
  if (!rig) return tl::unexpected(std::move(rig.error()));
  if (auto problems = check_buses(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  auto scene = build_scene(*rig);
  if (!scene) return tl::unexpected(std::move(scene.error()));
  Session session{std::move(*rig), std::move(*scene), nullptr};
  session.rays = std::make_unique<RayScene>(session.scene);
  return session;
}

Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options,
                                          const std::vector<double>& levels, ModelUsed* used) {
  EvaluateOptions evaluate;
  evaluate.wanted_relative_error = options.max_error;
  evaluate.seed = options.seed;
  evaluate.threads = options.threads;
  evaluate.levels = levels;
  evaluate.watch = options.watch;
  const auto receivers = receivers_of(session.rig);
  const auto emitters = all_emitters_of(session.rig);
  if (!levels.empty()) evaluate.levels.resize(emitters.size(), 1.0);
  EvaluatorChoice choice{nullptr, "asked for"};
  switch (options.model) {
    case Model::automatic: {
      auto chosen = choose_evaluator(*session.rays, receivers, emitters, evaluate);
      if (!chosen) return tl::unexpected(std::move(chosen.error()));
      choice = std::move(*chosen);
      break;
    }
    case Model::direct:
      choice.evaluator = make_direct_evaluator(*session.rays);
      break;
    case Model::gather:
      choice.evaluator = make_gather_evaluator(*session.rays);
      break;
    case Model::path:
      choice.evaluator = make_path_evaluator(*session.rays);
      break;
    case Model::cache:
      choice.evaluator = make_cache_evaluator(session.scene, *session.rays);
      break;
  }
  if (used) *used = {std::string(choice.evaluator->name()), choice.reason};
  return choice.evaluator->evaluate(receivers, emitters, evaluate);
}

std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                           const Eigen::VectorXd& levels) {
  const Eigen::VectorXd all_levels = levels_with_daylight(transport, levels);
  const Eigen::VectorXd lux = transport.lux(all_levels);
  const Eigen::VectorXd direct = transport.direct_lux(all_levels);
  const Eigen::VectorXd error = transport.standard_error_lux(all_levels);
  const Eigen::VectorXd daylight_lx = daylight_lux(rig, transport);
  std::vector<PlannedPoint> points;
  points.reserve(rig.points.size());
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    PlannedPoint point;
    point.name = rig.points[i].name;
    point.position_world_m = rig.points[i].position_world_m;
    point.normal_world = rig.points[i].normal_world;
    point.lux = lux[row];
    point.direct_lux = direct[row];
    point.standard_error_lux = error[row];
    if (rig.daylight) point.daylight_lux = daylight_lx[row];
    point.goal_lux = rig.points[i].goal_lx;
    points.push_back(std::move(point));
  }
  return points;
}

Result<Plan> solve_tasks(const Session& session, const TransportMatrix& transport, const ComputeOptions& options) {
  const auto start = Steady::now();
  const Rig& rig = session.rig;
  Plan plan;
  plan.rig = rig.name;
  plan.seed = options.seed;
  EmittanceProblem problem = problem_of(rig, transport);
  if (std::string broken = broken_by_daylight(rig, problem); !broken.empty()) {
    return tl::unexpected(Fault{Cause::invalid, "", std::move(broken), {}});
  }
  for (const Point& point : rig.points) problem.point_name.push_back(point.name);
  for (const Fixture& fixture : rig.fixtures) problem.light_name.push_back(fixture.name);
  Eigen::VectorXd level = Eigen::VectorXd::Zero(problem.lux_per_level.cols());
  std::vector<std::string> why(rig.points.size());
  for (const Task& task : rig.tasks) {
    const auto task_start = Steady::now();
    auto solution = solve_emittance(problem, options.watch);
    if (!solution) return tl::unexpected(std::move(solution.error()));
    level = solution->level;
    PlannedTask planned;
    planned.name = task.name;
    planned.kind = "emittance";
    planned.normalised_error = solution->normalised_error;
    planned.iterations = solution->iterations;
    planned.seconds = seconds_since(task_start);
    for (std::size_t j = 0; j < rig.fixtures.size(); ++j) {
      planned.lights.push_back(planned_light(rig, rig.fixtures[j], level[static_cast<Eigen::Index>(j)]));
    }
    for (std::size_t i = 0; i < why.size(); ++i) why[i] = solution->points[i].reason;
    plan.tasks.push_back(std::move(planned));
  }
  plan.points = predicted_points(rig, transport, level);
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    plan.points[i].why = why[i];
    if (!rig.points[i].max_lx) continue;
    const double lux = plan.points[i].lux;
    plan.limits.push_back({rig.points[i].name, *rig.points[i].max_lx, lux, lux <= *rig.points[i].max_lx});
  }
  plan.seconds = seconds_since(start);
  return plan;
}

LightModel light_model(const Rig& rig, const TransportMatrix& transport) {
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  const auto meters = static_cast<Eigen::Index>(rig.luxmeters.size());
  const auto lights = static_cast<Eigen::Index>(rig.fixtures.size());
  // Fixtures, then daylight in one column.
  const auto joined = [&](const Eigen::MatrixXd& lux_per_level) {
    Eigen::MatrixXd columns(points + meters, lights + 1);
    columns.leftCols(lights) = lux_per_level.leftCols(lights);
    columns.col(lights) = lux_per_level.rightCols(lux_per_level.cols() - lights).rowwise().sum();
    return columns;
  };
  const Eigen::MatrixXd lux = joined(transport.lux_per_level);
  LightModel model;
  model.point_lux_per_level = lux.topLeftCorner(points, lights);
  model.meter_lux_per_level = lux.bottomLeftCorner(meters, lights);
  const bool daylit = transport.emitters() > lights;
  if (daylit) {
    model.point_fixed_lx = lux.topRightCorner(points, 1);
    model.meter_fixed_lx = lux.bottomRightCorner(meters, 1);
  }
  if (!transport.replicates.empty()) {
    const auto count = static_cast<double>(transport.replicates.size());
    Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(points + meters, lights + 1);
    for (const auto& replicate : transport.replicates) variance += (joined(replicate) - lux).cwiseAbs2();
    const Eigen::MatrixXd error = (variance / (count * std::max(1.0, count - 1))).cwiseSqrt();
    model.point_standard_error = error.topLeftCorner(points, lights);
    model.meter_standard_error = error.bottomLeftCorner(meters, lights);
    if (daylit) {
      model.point_fixed_error_lx = error.topRightCorner(points, 1);
      model.meter_fixed_error_lx = error.bottomRightCorner(meters, 1);
    }
  }
  return model;
}

}  // namespace luxrig
