#include "core/solve/placement/place_in_scene.h"

#include <algorithm>
#include <cmath>

#include "core/solve/nnls.h"
#include "core/solve/placement/complement_search.h"
#include "core/solve/placement/place_lights.h"
#include "core/solve/placement/scene_light.h"
#include "core/transport/candidates/candidate_transport.h"

namespace luxrig {
namespace {

/// Columns of a search, which are what its time goes into: for each of its lights, up to those of ten. Reflected ones
/// cost some hundred times as much.
constexpr std::size_t kDirectColumnsPerLight = 15'000, kIndirectColumnsPerLight = 400;
/// The same when the number is to be found, of each number that is tried.
constexpr std::size_t kDirectColumnsOfTrial = 5'000, kIndirectColumnsOfTrial = 150;
constexpr std::size_t kLightsOfMostColumns = 10;
constexpr std::size_t kLookAhead = 2;

/// The search tries thousands of places, each a column; what it ends with is evaluated anew.
constexpr std::uint32_t kRaysPerColumn = 4096;

/// A light that hangs at the mounting's place nearest to the one it is asked for, so that a search that steps out of
/// the mounting slides along its edge.
class MountedLight final : public MovableLight {
 public:
  MountedLight(const MovableLight& light, const Mounting& mounting) : light_(light), mounting_(mounting) {}

  [[nodiscard]] Eigen::Index points() const override { return light_.points(); }
  bool column(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixX3d* lux_per_m) const override {
    const auto at = mounting_.snapped(place_world_m);
    if (!at || !light_.column(at->place_world_m, lux, lux_per_m)) return false;
    if (lux_per_m) *lux_per_m = *lux_per_m * at->per_wanted;
    return true;
  }

 private:
  const MovableLight& light_;
  const Mounting& mounting_;
};

/// The number of those tried at which to stop: the next one that is worth its lights takes its place.
std::size_t number_worth_it(const std::vector<LightsAndError>& numbers, double improvement) {
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const auto further = static_cast<double>(numbers[i].lights - numbers[chosen].lights);
    if (numbers[i].error <= numbers[chosen].error * std::pow(1 - improvement, further)) chosen = i;
  }
  return chosen;
}

bool reflects(const RayScene& rays) {
  return std::any_of(rays.materials().begin(), rays.materials().end(), [](const Material& material) {
    return material.reflectance_rgb.maxCoeff() > 0 || material.specular_reflectance > 0;
  });
}

/// With the best levels that the lights can give.
Result<PlacedInScene> found_by(const Placement& placement, const Mounting& mounting, const LightingGoal& goal,
                               double max_level) {
  PlacedInScene found;
  const PlacedLights& lights = placement.lights;
  NnlsProblem bounded{ColumnsView(lights.columns()), goal.weighted(), {}, {}};
  bounded.upper.setConstant(lights.columns().cols(), max_level);
  const auto solved = solve_nnls(bounded);
  if (!solved) return tl::unexpected(solved.error());
  found.error = solved->residual_norm / bounded.goal.norm();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    // It was added there, so it may hang there.
    if (lights.levels()[row] > 0 || solved->x[row] > 0)
      found.lights.push_back(
          {mounting.snapped(lights.places_world_m()[i])->place_world_m, std::nullopt, solved->x[row]});
  }
  return found;
}

}  // namespace

Result<PlacedInScene> place_in_scene(const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                     const Emitter& luminaire, std::span<const Receiver> receivers,
                                     const LightingGoal& goal, const PlaceInSceneOptions& options) {
  auto places_m = mounting.candidates(options.threads);
  if (!places_m) return tl::unexpected(std::move(places_m.error()));
  Emitter lamp = luminaire;
  lamp.shape = {};
  lamp.world_from_lamp.translation_m.setZero();
  const Watch watch{options.stop, {}};

  const bool indirect = options.indirect && reflects(rays);
  IncrementalOptions incremental;
  incremental.indirect = indirect;
  incremental.rays_per_column = kRaysPerColumn;
  incremental.seed = options.seed;
  incremental.threads = options.threads;
  const auto transport = IncrementalTransport::make(scene, rays, receivers, incremental, watch);
  if (!transport) return tl::unexpected(transport.error());
  const SceneLight anywhere(**transport, {receivers.begin(), receivers.end()}, lamp, indirect);
  const MountedLight light(anywhere, mounting);

  const CandidateSet set{std::move(*places_m), {lamp}};
  CandidateOptions how;
  how.indirect = indirect;
  how.seed = options.seed;
  how.threads = options.threads;
  how.watch = watch;
  const auto matrix = candidate_transport(scene, rays, receivers, set, how);
  if (!matrix) return tl::unexpected(matrix.error());
  const CandidateColumns& columns = matrix->matrix;
  if (columns.entries() == 0)
    return refusal(
        "from none of the places where a light may hang does light get to a point with a goal: let [mounting] "
        "reach into the room that the points are in");
  const ColumnsView view(light.points(), columns.begin, columns.receiver, columns.total_lux);
  const ComplementSearch candidates(view, set.positions_world_m, goal);

  PlaceOptions place;
  place.wanted_error = options.error_wanted;
  place.seed = options.seed;
  place.threads = options.threads;
  place.stop = options.stop;
  if (options.better)
    place.better = [&](const PlacedLights& best, std::size_t) { options.better(best.size(), best.error()); };
  const std::size_t first = options.lights.value_or(1), last = options.lights.value_or(options.max_lights);
  const std::size_t columns_per_light = options.lights ? indirect ? kIndirectColumnsPerLight : kDirectColumnsPerLight
                                        : indirect     ? kIndirectColumnsOfTrial
                                                       : kDirectColumnsOfTrial;
  if (indirect) {  // fewer tries for the dearer columns
    place.complements = 3;
    place.near_places = 12;
  }
  std::vector<PlacedInScene> of_number;
  std::vector<LightsAndError> numbers;
  std::size_t all_columns = 0;
  for (std::size_t lights = first; lights <= last && !options.stop.stop_requested(); ++lights) {
    place.lights = lights;
    place.most_columns = columns_per_light * std::min(lights, kLightsOfMostColumns);
    const Placement placement = place_lights(light, goal, candidates, place);
    all_columns += placement.columns;
    if (placement.lights.size() == 0) break;
    auto bounded = found_by(placement, mounting, goal, options.max_level);
    if (!bounded) return tl::unexpected(std::move(bounded.error()));
    PlacedInScene& found = *bounded;
    if (found.lights.empty()) break;
    // Cut short: what was there before may be the better one.
    if (!numbers.empty() && found.error >= numbers.back().error && options.stop.stop_requested()) break;
    numbers.push_back({lights, found.error});
    of_number.push_back(std::move(found));
    if (numbers.back().error <= options.error_wanted) break;
    if (numbers.size() - 1 - number_worth_it(numbers, options.improvement) >= kLookAhead) break;
  }
  if (of_number.empty()) {
    if (options.stop.stop_requested())
      return tl::unexpected(Fault{Cause::cancelled, "", "stopped before any light was placed", {}});
    return refusal("no light anywhere brings the points nearer to their goals");
  }
  PlacedInScene best = std::move(of_number[number_worth_it(numbers, options.improvement)]);
  best.numbers = std::move(numbers);
  best.candidates = set.positions_world_m.size();
  best.columns = all_columns;
  best.stopped = options.stop.stop_requested();
  return best;
}

}  // namespace luxrig
