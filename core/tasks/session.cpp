#include "core/tasks/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/solve/placement/scene/mounting.h"
#include "core/tasks/any_aim.h"
#include "core/tasks/rig_notes/rig_notes.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/rig_version.h"
#include "core/tasks/scene_builder.h"

namespace luxrig {

namespace {

/// What was measured at points holds for this scene, these points and lamps alone.
void drop_outdated_lights(Session& session) {
  if (session.rig.known_lights.empty()) return;
  std::vector<KnownLight> lights = std::exchange(session.rig.known_lights, {});
  if (version_of(session.rig, session.scene).light == session.rig.known_lights_of)
    session.rig.known_lights = std::move(lights);
  else
    session.rig.notes.push_back({session.rig.file.parent_path() / "calibration.json", 0, 0,
                                 "scene, points, luxmeters or lamps have changed since it was made",
                                 "what it found at points is not used any more: calibrate again"});
}

}  // namespace

Checked<Session> session_of(Rig rig) {
  if (auto problems = lamps_in_points(rig); !problems.empty()) return tl::unexpected(std::move(problems));
  auto scene = build_scene(rig);
  if (!scene) return tl::unexpected(std::move(scene.error()));
  Session session{std::move(rig), std::move(*scene), nullptr};
  session.rays = std::make_unique<RayScene>(session.scene);
  drop_outdated_lights(session);
  const bool places = std::any_of(session.rig.tasks.begin(), session.rig.tasks.end(),
                                  [](const Task& task) { return task.places_lights(); });
  if (places || !session.rig.mounting.surfaces.empty()) {
    auto mounting = Mounting::make(session.rig.mounting, session.rig.file, session.scene, *session.rays);
    if (!mounting) return tl::unexpected(std::move(mounting.error()));
  }
  return session;
}

Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options, const Look& look,
                                          ModelUsed* used, const KeptTransport* before) {
  return compute_transport(session.rig, *session.rays, options, look, used, before);
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
    if (point.goal_lux) point.goal_tolerance = rig.points[i].goal_tolerance;
    if (const auto& goal_rgb = rig.points[i].goal_rgb) point.goal_xy = xy_of_rgb(*goal_rgb);
    if (rgb.cols() == 3 && lux[row] > 0) point.xy = xy_of_rgb(rgb.row(row).transpose());
    points.push_back(std::move(point));
  }
  return points;
}

namespace {

/// How sure a calibration is of each fixture, and of its light at each point.
void add_spreads(const Rig& rig, LightModel& model) {
  const bool calibrated = std::any_of(rig.fixtures.begin(), rig.fixtures.end(),
                                      [](const Fixture& fixture) { return fixture.known_to.has_value(); });
  if (!calibrated) return;
  model.gain_sd.setConstant(static_cast<Eigen::Index>(rig.fixtures.size()), std::numeric_limits<double>::quiet_NaN());
  model.local_sd = model.gain_sd;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (const auto& known_to = rig.fixtures[f].known_to) {
      model.gain_sd[static_cast<Eigen::Index>(f)] = known_to->output;
      model.local_sd[static_cast<Eigen::Index>(f)] = known_to->local;
    }
  if (rig.known_lights.empty()) return;
  model.point_known_error.setZero(static_cast<Eigen::Index>(rig.points.size()), model.gain_sd.size());
  for (const KnownLight& light : rig.known_lights) {
    const auto& known_to = rig.fixtures[light.fixture].known_to;
    if (!known_to || !std::isfinite(known_to->output)) continue;
    const auto f = static_cast<Eigen::Index>(light.fixture);
    model.local_sd[f] = known_to->least_local;
    const double alike_lx = light.lux * std::hypot(known_to->output, known_to->least_local);
    model.point_known_error(static_cast<Eigen::Index>(light.point), f) =
        std::sqrt(std::max(0.0, light.standard_error_lx * light.standard_error_lx - alike_lx * alike_lx));
  }
}

}  // namespace

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
  add_spreads(rig, model);
  return model;
}

LightModel light_model(const Session& session, const TransportMatrix& transport) {
  LightModel model = light_model(session.rig, transport);
  add_untraced(session, model);
  return model;
}

void add_untraced(const Session& session, LightModel& model) {
  add_spreads(session.rig, model);
  model.any_aim_lux_per_level = any_aim_lux_per_level(session.rig, session.scene);
}

}  // namespace luxrig
