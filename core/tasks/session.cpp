#include "core/tasks/session.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/solve/placement/mounting.h"
#include "core/tasks/evaluator_choice.h"
#include "core/tasks/rig_notes/rig_notes.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"

namespace luxrig {

std::string ModelUsed::warning() const {
  if (reached()) return "";
  return fmt::format(
      "not as exact as wanted: error {:.2g} {}, wanted {:g}{}: {} or ask for less (--{}-error, --error-floor)",
      of_worst ? 2 * relative_error : rms_error, of_worst ? "of the worst point (two standard errors)" : "rms", wanted,
      time_was_up ? fmt::format(", when {:g} s were over", max_seconds) : ", after the most rays that are cast",
      time_was_up ? "give it more time (--max-seconds)" : "take another --model", of_worst ? "worst" : "max");
}

void ComputeOptions::want_error(EvaluateOptions& evaluate) const {
  if (worst_error)
    evaluate.wanted_relative_error = *worst_error;
  else
    evaluate.wanted_rms_error = max_error;
}

Checked<Session> session_of(Rig rig) {
  if (auto problems = lamps_in_points(rig); !problems.empty()) return tl::unexpected(std::move(problems));
  auto scene = build_scene(rig);
  if (!scene) return tl::unexpected(std::move(scene.error()));
  Session session{std::move(rig), std::move(*scene), nullptr};
  session.rays = std::make_unique<RayScene>(session.scene);
  const bool places = std::any_of(session.rig.tasks.begin(), session.rig.tasks.end(),
                                  [](const Task& task) { return task.places_lights(); });
  if (places || !session.rig.mounting.surfaces.empty()) {
    auto mounting = Mounting::make(session.rig.mounting, session.rig.file, session.scene, *session.rays);
    if (!mounting) return tl::unexpected(std::move(mounting.error()));
  }
  return session;
}

Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options, const Look& look,
                                          ModelUsed* used) {
  return compute_transport(session.rig, *session.rays, options, look, used);
}

Result<TransportMatrix> compute_transport(const Rig& rig, const RayScene& rays, const ComputeOptions& options,
                                          const Look& look, ModelUsed* used) {
  const std::optional<double> seconds = options.max_seconds > 0 ? std::optional(options.max_seconds) : std::nullopt;
  const Stage stage(options.watch.without_stop(), options.stage, "starting", seconds);
  EvaluateOptions evaluate;
  options.want_error(evaluate);
  evaluate.levels = look.levels;
  evaluate.run() = options;
  evaluate.enough = stage.stop();
  if (options.watch.tell)
    evaluate.watch.progress = [&](double done) {
      stage.say(fmt::format("{:.0f} %", 100 * done));
      if (options.watch.progress) options.watch.progress(done);
    };
  set_error_floor(rig, evaluate);
  if (options.error_floor_lx) {
    evaluate.floor_lx = *options.error_floor_lx / evaluate.wanted_standard_error();
    evaluate.floor_of_mean = 0;
  }
  evaluate.colour = rig.colour_goals();
  const auto receivers = receivers_of(rig);
  const auto emitters = all_emitters_of(rig, look.joints);
  const double wanted = options.worst_error.value_or(options.max_error);
  if (emitters.empty()) {  // a rig in which all light is yet to be placed
    if (used) *used = {"direct", "nothing shines", wanted, options.worst_error.has_value()};
    TransportMatrix dark;
    dark.lux_per_level = dark.direct_lux_per_level =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), 0);
    if (evaluate.colour) dark.rgb_per_level.assign(3, dark.lux_per_level);
    return dark;
  }
  if (!look.levels.empty()) evaluate.levels.resize(emitters.size(), 1.0);
  EvaluatorChoice choice{nullptr, "asked for"};
  switch (options.model) {
    case Model::automatic: {
      auto chosen = choose_evaluator(rays, receivers, emitters, evaluate);
      if (!chosen) return tl::unexpected(std::move(chosen.error()));
      choice = std::move(*chosen);
      break;
    }
    case Model::direct:
      choice.evaluator = make_direct_evaluator(rays);
      break;
    case Model::gather:
      choice.evaluator = make_gather_evaluator(rays);
      break;
    case Model::path:
      choice.evaluator = make_path_evaluator(rays);
      break;
  }
  auto transport = choice.evaluator->evaluate(receivers, emitters, evaluate);
  if (used && transport)
    *used = {.name = std::string(choice.evaluator->name()),
             .reason = choice.reason,
             .wanted = wanted,
             .of_worst = options.worst_error.has_value(),
             .relative_error = transport->relative_error,
             .rms_error = transport->rms_error,
             .error_floor_lx = evaluate.wanted_standard_error() * transport->floor_lx,
             .time_was_up = stage.time_is_up(),
             .max_seconds = options.max_seconds};
  return transport;
}

std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                           const Eigen::VectorXd& levels) {
  const Eigen::VectorXd all_levels = levels_with_daylight(transport, levels);
  const Eigen::VectorXd lux = transport.lux(all_levels);
  const Eigen::VectorXd direct = transport.direct_lux(all_levels);
  const Eigen::VectorXd error = transport.standard_error_lux(all_levels);
  const Eigen::VectorXd daylight_lx = daylight_lux(rig, transport);
  Eigen::MatrixXd rgb(lux.size(), static_cast<Eigen::Index>(transport.rgb_per_level.size()));
  for (Eigen::Index c = 0; c < rgb.cols(); ++c)
    rgb.col(c) = transport.rgb_per_level[static_cast<std::size_t>(c)] * all_levels;
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
    if (point.goal_lux) point.weight = rig.points[i].weight;
    point.max_lux = rig.points[i].max_lx;
    if (const auto& goal_rgb = rig.points[i].goal_rgb) point.goal_xy = xy_of_rgb(*goal_rgb);
    if (rgb.cols() == 3 && lux[row] > 0) point.xy = xy_of_rgb(rgb.row(row).transpose());
    points.push_back(std::move(point));
  }
  return points;
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
