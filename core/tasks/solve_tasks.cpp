#include "core/tasks/solve_tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/rig/point_goals.h"
#include "core/solve/emittance.h"
#include "core/tasks/placement_task.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/rig_version.h"
#include "core/tasks/task_solver.h"

namespace luxrig {
namespace {

PlannedLight planned_light(const Rig& rig, const Fixture& fixture, const Joints& joints,
                           const std::optional<Vec3>& aim_world_m, double level) {
  const Luminaire& luminaire = rig.luminaires[fixture.luminaire];
  PlannedLight light;
  light.name = fixture.name;
  light.luminaire = luminaire.name;
  light.position_world_m = fixture.world_from_mount.translation_m;
  light.aim_world_m = aim_world_m;
  light.joints = Joints{joints.pan_rad, joints.tilt_rad, fixture.range.zooms() ? joints.beam_rad : 0};
  light.level = level;
  light.solved_level = level;
  light.lumens = level * luminaire.lumens;
  if (luminaire.watts) light.watts = level * *luminaire.watts;
  return light;
}

}  // namespace

TaskSolver::TaskSolver(const Session& session, const TransportMatrix& transport, const ComputeOptions& options)
    : session_(session),
      options_(options),
      zones_(session.rig),
      rig_(session.rig),
      look_(hung_look(rig_)),
      transport_(transport),
      lit_joints_(look_.joints),
      own_(static_cast<Index>(rig_.fixtures.size())),
      level_(Eigen::VectorXd::Zero(own_)),
      why_(rig_.points.size()) {
  plan_.rig = rig_.name;
  plan_.seed = options.seed;
}

Result<void> TaskSolver::emittance(const Task& task) {
  const auto start = Steady::now();
  PlannedTask planned;
  planned.name = task.name;
  planned.kind = name_of(task.kind);
  const auto max_watts = watts_left(0, own_, task);
  if (!max_watts) return tl::unexpected(max_watts.error());
  if (auto solved = solve_levels_of(0, own_, *max_watts, planned); !solved) return solved;
  planned.seconds = seconds_since(start);
  plan_.tasks.push_back(std::move(planned));
  return {};
}

void TaskSolver::light_as_hung() {
  for (Index j = 0; j < own_; ++j) level_[j] = max_level(j);
  const Eigen::VectorXd lux = lux_of_points();
  double share = 1;
  for (std::size_t i = 0; i < rig_.points.size(); ++i)
    if (const auto& max_lx = rig_.points[i].max_lx; max_lx && lux[static_cast<Index>(i)] > *max_lx)
      share = std::min(share, *max_lx / lux[static_cast<Index>(i)]);
  level_ *= share;
  PlannedTask planned;
  planned.name = kAsItHangs;
  planned.kind = name_of(TaskKind::emittance);
  list(planned, 0, own_);
  plan_.tasks.push_back(std::move(planned));
}

Result<void> TaskSolver::placement(const Task& task) {
  const auto start = Steady::now();
  const auto mounting = Mounting::make(rig_.mounting, rig_.file, session_.scene, *session_.rays);
  if (!mounting) return refusal(mounting.error()[0].text());  // session_of() has already made it
  const PlacementSpec& spec = task.placement;
  for (Index j = 0; j < own_ && spec.fixtures != FixturesMeanwhile::as_set; ++j)
    level_[j] = spec.fixtures == FixturesMeanwhile::full ? max_level(j) : 0;
  const Index before = level_.size();
  const EmittanceProblem nothing_yet = problem_of(before, before);
  if (auto kept = limits_left(nothing_yet.fixed_lx); !kept) return kept;
  const auto max_watts = watts_left(before, before, task);
  if (!max_watts) return tl::unexpected(max_watts.error());
  auto placed = search_places(rig_, session_.scene, *session_.rays, *mounting, task,
                              {nothing_yet.fixed_lx, nothing_yet.fixed_rgb}, *max_watts, options_);
  if (!placed) return tl::unexpected(std::move(placed.error()));

  PlannedTask planned;
  planned.name = task.name;
  planned.kind = name_of(task.kind);
  if (auto hung = hang(task, spec.luminaire, placed->lights); !hung) return hung;
  if (auto solved = solve_levels_of(before, level_.size(), *max_watts, planned); !solved) return solved;
  for (Index j = 0; j < own_; ++j) planned.fixtures.push_back(light_of(j));
  for (const LightsAndError& tried : placed->numbers)
    planned.numbers.push_back({static_cast<int>(tried.lights), tried.error});
  for (const PowerAndError& power : placed->front) planned.front.push_back({power.max_watts, power.watts, power.error});
  planned.lower_bound = placed->lower_bound;
  planned.lower_bound_of_number = placed->lower_bound_of_number;
  planned.iterations =
      static_cast<int>(std::min(placed->columns, static_cast<std::size_t>(std::numeric_limits<int>::max())));
  planned.seconds = seconds_since(start);
  plan_.tasks.push_back(std::move(planned));
  return {};
}

SolvedTasks TaskSolver::done() {
  plan_.points = predicted_points(rig_, transport_, level_);
  for (std::size_t i = 0; i < plan_.points.size(); ++i) {
    plan_.points[i].why = why_[i];
    if (!rig_.points[i].max_lx) continue;
    const double lux = plan_.points[i].lux;
    plan_.limits.push_back({rig_.points[i].name, *rig_.points[i].max_lx, lux, lux <= *rig_.points[i].max_lx});
  }
  plan_.made_for = version_of(session_.rig, session_.scene);
  // After an aim, the light predicted by the plan is held: the points' goals are set aside.
  if (holds_a_look(plan_))
    for (PlannedPoint& point : plan_.points) point.goal_lux.reset();
  judge(plan_, rig_.control.goal_tolerance);
  plan_.seconds = seconds_since(start_);
  return {std::move(plan_), std::move(rig_), look(), std::move(transport_), std::move(used_), std::move(reasons_)};
}

PlannedLight TaskSolver::light_of(Index light) const {
  const auto f = static_cast<std::size_t>(light);
  return planned_light(rig_, rig_.fixtures[f], look_.joints[f], look_.aim_world_m[f], level_[light]);
}

EmittanceProblem TaskSolver::problem_of(Index begin, Index end) const {
  const auto points = static_cast<Index>(rig_.points.size());
  Eigen::VectorXd others = level_;
  others.segment(begin, end - begin).setZero();
  EmittanceProblem problem;
  problem.lux_per_level = transport_.lux_per_level.block(0, begin, points, end - begin);
  problem.fixed_lx = transport_.lux(levels_with_daylight(transport_, others)).head(points);
  PointGoals goals = point_goals(rig_.points, rig_.colour_goals());
  problem.goal_lx = std::move(goals.goal_lx);
  problem.goal_rgb = std::move(goals.rgb);
  problem.weight = std::move(goals.weight);
  problem.max_lx = std::move(goals.max_lx);
  for (const Point& point : rig_.points) problem.point_name.push_back(point.name);
  if (rig_.colour_goals()) {
    problem.fixed_rgb.resize(points, 3);
    for (Index c = 0; c < 3; ++c) {
      const Eigen::MatrixXd& primary = transport_.rgb_per_level[static_cast<std::size_t>(c)];
      problem.rgb_per_level.push_back(primary.block(0, begin, points, end - begin));
      problem.fixed_rgb.col(c) = (primary * levels_with_daylight(transport_, others)).head(points);
    }
  }
  problem.max_level.resize(end - begin);
  problem.watts.resize(end - begin);
  for (Index j = begin; j < end; ++j) {
    problem.max_level[j - begin] = max_level(j);
    problem.watts[j - begin] = watts_of(j).value_or(0);
    problem.switched.push_back(rig_.fixtures[static_cast<std::size_t>(j)].switched && max_level(j) > 0);
    problem.light_name.push_back(rig_.fixtures[static_cast<std::size_t>(j)].name);
  }
  return problem;
}

Result<void> TaskSolver::limits_left(const Eigen::VectorXd& fixed_lx) const {
  const Eigen::VectorXd daylight_lx = daylight_lux(rig_, transport_);
  std::string broken;
  bool by_daylight = true;
  for (std::size_t i = 0; i < rig_.points.size(); ++i) {
    const auto row = static_cast<Index>(i);
    if (!rig_.points[i].max_lx || fixed_lx[row] <= *rig_.points[i].max_lx) continue;
    const bool of_day = daylight_lx[row] > *rig_.points[i].max_lx;
    by_daylight = by_daylight && of_day;
    broken += fmt::format("{}point \"{}\" has {:.4g} lx of {} alone, its limit is {:.4g} lx",
                          broken.empty() ? "" : "; ", rig_.points[i].name, of_day ? daylight_lx[row] : fixed_lx[row],
                          of_day ? "daylight" : "light that stays as it is", *rig_.points[i].max_lx);
  }
  if (broken.empty()) return {};
  return refusal(broken + (by_daylight ? ": shade the opening, move the point or raise its max_lx"
                                       : ": dim what is there (fixtures = \"off\"), or raise its max_lx"));
}

Result<double> TaskSolver::watts_left(Index begin, Index end, const Task& task) const {
  double watts = task.max_watts.value_or(std::numeric_limits<double>::infinity());
  if (!rig_.limits.max_watts) return watts;
  double others = 0;
  for (Index j = 0; j < level_.size(); ++j)
    if (j < begin || j >= end) others += level_[j] * watts_of(j).value_or(0);
  if (others > *rig_.limits.max_watts)
    return refusal(fmt::format(
        "task \"{}\": lights that stay as they are take {:.4g} W, max_watts of [limits] is {:g} W: dim them "
        "(fixtures = \"off\"), or raise it",
        task.name, others, *rig_.limits.max_watts));
  return std::min(watts, *rig_.limits.max_watts - others);
}

Result<void> TaskSolver::solve_levels_of(Index begin, Index end, double max_watts, PlannedTask& planned) {
  EmittanceProblem problem = problem_of(begin, end);
  problem.max_watts = max_watts;
  if (auto kept = limits_left(problem.fixed_lx); !kept) return kept;
  const Stage stage(options_.watch.without_stop(), planned.name,
                    fmt::format("levels of {} lights at {} points", end - begin, rig_.points.size()));
  // An interrupt ends the search, not the use of its result.
  auto solution = solve_emittance(problem, planned.kind == name_of(TaskKind::placement) ? Watch{} : options_.watch);
  if (!solution) return tl::unexpected(std::move(solution.error()));
  level_.segment(begin, end - begin) = solution->level;
  planned.normalised_error = solution->normalised_error;
  planned.iterations = solution->iterations;
  planned.switches_proven = solution->switches_proven;
  list(planned, begin, end);
  for (std::size_t i = 0; i < why_.size(); ++i) why_[i] = solution->points[i].reason;
  return {};
}

Result<void> TaskSolver::hang(const Task& task, std::size_t luminaire, std::span<const LightInScene> lights) {
  if (lights.empty()) return {};
  int number = 0;
  const auto taken = [&](const std::string& name) {
    return std::any_of(rig_.fixtures.begin(), rig_.fixtures.end(),
                       [&](const Fixture& f) { return f.name == name || f.name.starts_with(name + "/"); });
  };
  std::vector<double> evaluated = levels();
  for (const LightInScene& light : lights) {
    std::string name;
    do name = fmt::format("{} {}", task.name, ++number);
    while (taken(name));
    const std::string& whole = rig_.luminaires[luminaire].name;
    const auto parts = rig_.emitters_or_itself(luminaire);
    for (std::size_t e = 0; e < parts.size(); ++e) {
      // Named as in the rig file: "<name>/<emitter>".
      const std::string called = name + rig_.luminaires[parts[e]].name.substr(whole.size());
      rig_.fixtures.push_back(hung_light(rig_, called, parts[e], light.position_world_m, light.aim_world_m));
      look_.joints.push_back(rig_.fixtures.back().joints);
      look_.aim_world_m.push_back(light.aim_world_m);
      evaluated.push_back(std::min(light.levels[e], max_level(static_cast<Index>(rig_.fixtures.size()) - 1)));
    }
  }
  level_.conservativeResizeLike(Eigen::VectorXd::Zero(static_cast<Index>(evaluated.size())));
  Look shone = look_;
  shone.levels = std::move(evaluated);
  return light_anew(shone);
}

Result<void> TaskSolver::light_anew(const Look& look) {
  ComputeOptions compute = options_;
  compute.watch = options_.watch.without_stop();
  ModelUsed used;
  const KeptTransport before{lit_joints_, transport_};
  auto transport = compute_transport(rig_, *session_.rays, compute, look, &used, &before);
  if (!transport) return tl::unexpected(std::move(transport.error()));
  transport_ = std::move(*transport);
  lit_joints_ = look.joints;
  used_ = std::move(used);
  return {};
}

Eigen::VectorXd TaskSolver::lux_of_points() const {
  return transport_.lux(levels_with_daylight(transport_, level_)).head(static_cast<Index>(rig_.points.size()));
}

void TaskSolver::list(PlannedTask& planned, Index begin, Index end) const {
  planned.watts = 0;
  for (Index j = begin; j < end; ++j) {
    planned.lights.push_back(light_of(j));
    if (!watts_of(j)) planned.watts.reset();
    if (planned.watts) *planned.watts += *planned.lights.back().watts;
  }
}

namespace {

Result<void> done_by(TaskSolver& solver, const Task& task) {
  switch (task.kind) {
    case TaskKind::emittance:
      return solver.emittance(task);
    case TaskKind::placement:
      return solver.placement(task);
    case TaskKind::aim:
      return solver.aim(task);
    case TaskKind::highlight:
      return solver.highlight(task);
    case TaskKind::directions:
      return solver.directions(task);
  }
  return refusal("an unknown kind of task");
}

}  // namespace

Result<SolvedTasks> solve_tasks(const Session& session, const TransportMatrix& transport,
                                const ComputeOptions& options) {
  TaskSolver solver(session, transport, options);
  for (const Task& task : session.rig.tasks) {
    if (auto done = done_by(solver, task); !done) return tl::unexpected(std::move(done.error()));
    // An interrupted search has given its best so far, which the person wants to see.
    if (task.kind != TaskKind::emittance && options.watch.stop.stop_requested()) break;
  }
  return solver.done();
}

bool levels_set_before(const Rig& rig, const std::string& task_name) {
  for (const Task& task : rig.tasks) {
    if (task.name == task_name) return false;
    if (task.sets_levels()) return true;
  }
  return false;
}

Result<SolvedTasks> solve_what_hangs(const Session& session, const TransportMatrix& transport,
                                     const ComputeOptions& options, bool aim) {
  TaskSolver solver(session, transport, options);
  bool any = false;
  for (const Task& task : session.rig.tasks) {
    if (!task.sets_levels() || (task.kind == TaskKind::aim && !aim)) continue;
    any = true;
    if (auto done = done_by(solver, task); !done) return tl::unexpected(std::move(done.error()));
  }
  const bool wanted = std::any_of(session.rig.points.begin(), session.rig.points.end(),
                                  [](const Point& point) { return point.goal_lx.has_value(); });
  if (!any && !wanted && !aim) {
    solver.light_as_hung();
  } else if (!any) {
    if (auto done = solver.emittance({"levels", TaskKind::emittance, {}}); !done)
      return tl::unexpected(std::move(done.error()));
  }
  return solver.done();
}

}  // namespace luxrig
