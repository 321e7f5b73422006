#include "core/tasks/placement_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rig/point_goals.h"
#include "core/tasks/light.h"
#include "core/tasks/rig_transport.h"

namespace luxrig {
namespace {

/// The goal for the points with a goal or a limit; with colour, three channels.
struct GoalOfPoints {
  std::vector<Receiver> receivers;
  LightingGoal goal;
};

GoalOfPoints goal_of_points(const Rig& rig, const LightThere& there) {
  GoalOfPoints of;
  const PointGoals asked = point_goals(rig.points, rig.colour_goals());
  std::vector<Eigen::Index> rows;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    const auto i = static_cast<Eigen::Index>(p);
    if (!asked.asks(i) && !asked.limits(i)) continue;
    of.receivers.push_back({rig.points[p].position_world_m, rig.points[p].normal_world});
    rows.push_back(i);
  }
  const auto points = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index channels = rig.colour_goals() ? 3 : 1;
  LightingGoal& goal = of.goal;
  goal.lux = goal.fixed_lux = goal.row_weight = Eigen::VectorXd::Zero(points * channels);
  goal.max_lux.resize(points);
  for (Eigen::Index k = 0; k < points; ++k) {
    const Eigen::Index i = rows[static_cast<std::size_t>(k)];
    goal.max_lux[k] = asked.max_lx[i];
    for (Eigen::Index c = 0; c < channels; ++c) {
      const Eigen::Index row = c * points + k;
      const double is = channels == 1 ? there.lux[i] : there.rgb(i, c);
      goal.fixed_lux[row] = is;
      if (!asked.asks(i)) continue;
      goal.lux[row] = asked.goal_lx[i] * (channels == 1 ? 1.0 : asked.rgb(i, c));
      // Light that is there above a goal is not the placed lights' fault.
      goal.fixed_lux[row] = std::min(is, goal.lux[row]);
      goal.row_weight[row] = asked.weight[i] / std::sqrt(static_cast<double>(channels));
    }
  }
  return of;
}

/// Light of each emitter of a luminaire, per unit of the luminaire with all emitters at rated flux.
void set_emitters(const Rig& rig, std::size_t luminaire, LightingGoal& goal, Eigen::Index channels) {
  const std::vector<std::size_t> emitters = rig.emitters_or_itself(luminaire);
  const auto count = static_cast<Eigen::Index>(emitters.size());
  goal.emitters.resize(channels, count);
  goal.watts = Eigen::VectorXd::Zero(count);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Luminaire& emitter = rig.luminaires[emitters[static_cast<std::size_t>(e)]];
    const double share = emitter.lumens / rig.luminaires[luminaire].lumens;
    goal.emitters.col(e) =
        channels == 1 ? Eigen::VectorXd::Constant(1, share) : Eigen::VectorXd(share * emitter.colour_rgb);
    goal.watts[e] = emitter.watts.value_or(0);
  }
}

}  // namespace

Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                    const Task& task, const LightThere& there, double max_watts,
                                    const ComputeOptions& options) {
  const PlacementSpec& spec = task.placement;
  const Eigen::Index channels = rig.colour_goals() ? 3 : 1;
  auto [receivers, goal] = goal_of_points(rig, there);
  if (!(goal.weighted().maxCoeff() > 0)) return PlacedInScene{};
  set_emitters(rig, spec.luminaire, goal, channels);
  goal.max_watts = max_watts;

  const Stage stage(options.watch, task.name, "looking at places", spec.seconds);
  PlaceInSceneOptions place;
  if (spec.lights) place.lights = static_cast<std::size_t>(*spec.lights);
  place.max_lights = static_cast<std::size_t>(spec.max_lights);
  place.error_wanted = spec.error_wanted;
  place.improvement = spec.improvement;
  place.max_level = rig.limits.max_level;
  place.method = name_of(spec.method);
  place.aimed = spec.aimed;
  place.indirect = spec.indirect && options.model != Model::direct;
  place.bound_of_number = spec.bound;
  place.run() = options.of_part();
  place.watch.stop = stage.stop();
  place.better = [&](std::size_t lights, double error) {
    stage.say(fmt::format("{} light{}, error {:.2f} %", lights, lights == 1 ? "" : "s", 100 * error));
  };
  place.front_limits = static_cast<std::size_t>(spec.energy_front);
  const Luminaire& luminaire = rig.luminaires[spec.luminaire];
  const auto points = static_cast<Eigen::Index>(receivers.size());
  place.lux_of = [&, &receivers = receivers, &goal = goal](std::span<const LightPose> poses,
                                                           const Eigen::VectorXd& levels) -> Result<Eigen::VectorXd> {
    std::vector<Emitter> lamps;
    EvaluateOptions evaluate;
    evaluate.colour = channels == 3;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      // A lamp's emitters have the same distribution and differ in colour: together they are one lamp of their mixture.
      const Eigen::VectorXd light =
          goal.emitters * levels.segment(static_cast<Eigen::Index>(i) * goal.emitters.cols(), goal.emitters.cols());
      const double level = channels == 3 ? luminance_of_rgb(light) : light[0];
      if (!(level > 0)) continue;
      lamps.push_back(emitter_of(luminaire, {aimed_rotation(Mat3::Identity(), poses[i].aim_world),
                                             mounting.snapped(poses[i].position_world_m)->place_world_m}));
      if (channels == 3) lamps.back().colour_rgb = light / level;
      evaluate.levels.push_back(level);
    }
    if (lamps.empty()) return Eigen::VectorXd::Zero(points * channels);
    set_error_floor(rig, evaluate);
    ComputeOptions compute = options;
    compute.run() = place;
    compute.watch.tell = nullptr;
    if (!place.indirect) compute.model = Model::direct;
    const auto lit = light_of(rays, receivers, lamps, evaluate, compute);
    if (!lit) return tl::unexpected(lit.error());
    const Eigen::Map<const Eigen::VectorXd> at(evaluate.levels.data(),
                                               static_cast<Eigen::Index>(evaluate.levels.size()));
    if (channels == 1) return Eigen::VectorXd(lit->lux(at));
    Eigen::VectorXd rgb(points * channels);
    for (Eigen::Index c = 0; c < channels; ++c)
      rgb.segment(c * points, points) = lit->rgb_per_level[static_cast<std::size_t>(c)] * at;
    return rgb;
  };
  return place_in_scene(scene, rays, mounting, emitter_of(luminaire, Pose{}), receivers, goal, place);
}

}  // namespace luxrig
