#include "core/solve/placement/scene/place_in_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/solve/bounds/goal_bounds.h"
#include "core/solve/placement/corrected_placement.h"
#include "core/solve/placement/energy_front.h"
#include "core/solve/placement/placement_methods.h"
#include "core/solve/placement/scene/mounted_light.h"
#include "core/solve/placement/scene/search_space.h"

namespace luxrig {
namespace {

/// Directions tried at each place with an aimed light.
constexpr std::size_t kAims = 26;

/// Columns of a search: they take most of its time. Reflected light of an aimed light costs about a hundred times as
/// much.
constexpr std::size_t kMaxColumns = 150'000, kReflectedColumns = 80'000, kMaxTracedColumns = 4'000;

bool reflects(const RayScene& rays) {
  return std::any_of(rays.materials().begin(), rays.materials().end(), [](const Material& material) {
    return material.reflectance_rgb.maxCoeff() > 0 || material.specular_reflectance > 0;
  });
}

/// Emittance factors of the lights at their mounted places; dark lights are left out.
std::vector<LightInScene> lit_ones(const PlacedLights& lights, const Mounting& mounting, bool aimed) {
  std::vector<LightInScene> lit;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto levels = lights.levels().segment(static_cast<Eigen::Index>(i) * lights.emitters(), lights.emitters());
    if (!(levels.maxCoeff() > 0)) continue;
    const LightPose& pose = lights.poses()[i];
    // It was added there, so it may hang there.
    LightInScene light{mounting.snapped(pose.position_world_m)->place_world_m,
                       std::nullopt,
                       levels.maxCoeff(),
                       {levels.begin(), levels.end()}};
    if (aimed) light.aim_world_m = light.position_world_m + pose.aim_world;
    lit.push_back(light);
  }
  return lit;
}

/// Error against power, starting from the found lights.
std::vector<PowerAndError> front_of(const PlacementProblem& problem, const LightingGoal& goal,
                                    const PlacedLights& lights, const PlaceInSceneOptions& options) {
  constexpr int kRounds = 2;
  const double watts = lights.watts();
  if (options.front_limits == 0 || !(watts > 0) || options.watch.stop.stop_requested()) return {};
  const ComplementSearch candidates(problem.columns, problem.poses, goal);
  ExchangeOptions of_exchange = ExchangeOptions::for_spacing(problem.spacing_m);
  of_exchange.run() = options.of_part();
  LightExchange exchange(candidates, of_exchange);
  std::vector<double> limits;
  for (std::size_t k = 0; k <= options.front_limits; ++k)
    limits.push_back(watts * (1 - static_cast<double>(k) / static_cast<double>(options.front_limits + 1)));
  const auto found = energy_front(*problem.light, goal, lights, limits, exchange, kRounds, options.seed);
  std::vector<PowerAndError> front;
  for (std::size_t k = 0; k < found.size(); ++k)
    front.push_back({limits[k], found[k].lights.watts(), found[k].lights.error()});
  return front;
}

}  // namespace

Result<PlacedInScene> place_in_scene(const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                     const Emitter& luminaire, std::span<const Receiver> receivers,
                                     const LightingGoal& goal, const PlaceInSceneOptions& options) {
  const PlacementMethod* method = find_placement_method(options.method);
  if (!method) return refusal(fmt::format("no method of placement is called \"{}\"", options.method));
  auto places_m = mounting.candidates(options.threads);
  if (!places_m) return tl::unexpected(std::move(places_m.error()));

  SearchSpaceOptions of_space;
  of_space.indirect = options.indirect && reflects(rays);
  if (options.aimed) of_space.aims_world = aims_over_sphere(kAims);
  of_space.run() = options.of_part();
  // The shape matters when the found lights are corrected; with it, the search would take a hundred times as long.
  Emitter lamp = luminaire;
  lamp.shape = {};
  const bool has_size = luminaire.shape.kind != LuminousShape::Kind::point;
  const auto space = SearchSpace::make(scene, rays, receivers, lamp, *places_m, of_space);
  if (!space) return tl::unexpected(space.error());
  const MountedLight light(space->light(), mounting);
  LightingGoal bounded = goal;
  bounded.max_level = std::min(goal.max_level, options.max_level);

  PlacementProblem problem;
  problem.light = &light;
  problem.goal = &bounded;
  problem.columns = space->columns();
  problem.poses.assign(space->poses().begin(), space->poses().end());
  problem.spacing_m = mounting.spacing_m();
  if (!space->lights_anything())
    return refusal(
        "from none of the places where a light may hang does light get to a point with a goal: let [mounting] "
        "reach into the room that the points are in");

  PlacementOptions place;
  place.lights = options.lights.value_or(0);
  place.max_lights = options.max_lights;
  place.number.wanted_error = options.error_wanted;
  place.number.min_improvement = options.improvement;
  place.max_columns = !of_space.indirect ? kMaxColumns : options.aimed ? kMaxTracedColumns : kReflectedColumns;
  place.whole_curve = true;
  place.run() = options.of_part();
  if (options.better) place.better = [&](const BestSoFar& best) { options.better(best.poses.size(), best.error); };
  CorrectedPlacementOptions correction;
  if (of_space.indirect || has_size) correction.lux_of = options.lux_of;
  const auto done = place_and_correct(*method, problem, place, correction);
  if (!done) return tl::unexpected(done.error());

  PlacedInScene placed;
  placed.columns = done->columns;
  const PlacedLights& lights = done->corrected ? done->corrected->lights : done->found.lights;
  placed.lights = lit_ones(lights, mounting, options.aimed);
  if (placed.lights.empty()) {
    if (options.watch.stop.stop_requested())
      return tl::unexpected(Fault{Cause::cancelled, "", "stopped before any light was placed", {}});
    return refusal("no light anywhere brings the points nearer to their goals");
  }
  placed.error = done->corrected ? done->corrected->error : lights.error();
  for (const PlacedLights& cut : done->found.cuts)
    if (cut.size() > (placed.numbers.empty() ? 0 : placed.numbers.back().lights))
      placed.numbers.push_back({cut.size(), cut.error()});
  if (placed.numbers.empty()) placed.numbers.push_back({lights.size(), placed.error});
  if (placed.error > options.error_wanted && !options.watch.stop.stop_requested()) {
    placed.lower_bound = goal_error_bound(problem.columns, bounded, options.watch.stop);
    if (options.bound_of_number) {
      CountBoundOptions counted;
      counted.max_lights = placed.lights.size();
      // With the search's own light: the residual of corrected lights comes from the evaluator.
      counted.guesses = {{placed.lights.size(), done->found.lights.residual()}};
      counted.run() = options.of_part();
      placed.lower_bound_of_number =
          std::max(*placed.lower_bound, goal_error_bounds_by_count(problem.columns, bounded, counted).back());
    }
  }
  placed.front = front_of(problem, done->corrected ? *done->corrected->goal : bounded, lights, options);
  placed.candidates = problem.poses.size();
  placed.stopped = options.watch.stop.stop_requested();
  return placed;
}

}  // namespace luxrig
