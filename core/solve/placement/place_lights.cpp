#include "core/solve/placement/place_lights.h"

#include <algorithm>
#include <optional>
#include <random>

#include "core/check.h"
#include "core/parallel.h"
#include "core/solve/placement/refine_lights.h"

namespace luxrig {
namespace {

constexpr int kQuickSteps = 4;       ///< of refinement, for what may be dropped again
constexpr std::size_t kRefined = 3;  ///< of the ways to put a light back that are refined at all

class Search {
 public:
  Search(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
         const PlaceOptions& options)
      : candidates_(candidates), options_(options), best_{PlacedLights(light, goal), 0, 0} {}

  Placement run() {
    for (std::uint64_t start = 0; !ended() && start < kMostStarts; ++start) {
      ++best_.starts;
      std::mt19937_64 random(options_.seed * 0x9E3779B97F4A7C15ull + start);
      PlacedLights lights = added_one_by_one(start, random);
      offer(lights);
      while (!ended() && improve(lights, random)) offer(lights);
    }
    return std::move(best_);
  }

 private:
  static constexpr std::uint64_t kMostStarts = 1'000;

  [[nodiscard]] bool ended() const {
    return options_.stop.stop_requested() || best_.lights.error() <= options_.wanted_error ||
           best_.columns >= options_.most_columns;
  }

  void offer(const PlacedLights& lights) {
    if (best_.lights.size() > 0 && !(lights.error() < best_.lights.error())) return;
    best_.lights = lights;
    if (options_.better) options_.better(best_.lights, best_.columns);
  }

  RefineOptions steps(int most) const {
    RefineOptions refine;
    refine.most_steps = most;
    refine.stop = options_.stop;
    return refine;
  }

  /// The first start takes the best each time, later ones one of the three best.
  PlacedLights added_one_by_one(std::uint64_t start, std::mt19937_64& random) {
    PlacedLights lights = best_.lights;
    while (lights.size() > 0) lights.drop(lights.size() - 1);
    while (lights.size() < options_.lights && !options_.stop.stop_requested()) {
      const auto found = candidates_.best(lights, start == 0 ? 1 : 3, options_.apart_m);
      if (found.empty()) break;
      const std::size_t taken =
          start == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, found.size() - 1)(random);
      if (!lights.add(candidates_.place_world_m(found[taken].candidate))) break;
      ++best_.columns;
      best_.columns += refine_lights(lights, steps(2 * kQuickSteps));
    }
    best_.columns += refine_lights(lights, steps(RefineOptions{}.most_steps));
    return lights;
  }

  struct Trial {
    std::optional<PlacedLights> lights;
    std::size_t columns = 0;
  };

  /// The lights without one of them, and the best found in its place.
  Trial exchanged(const PlacedLights& lights, std::size_t light, std::uint64_t seed) const {
    Trial trial;
    const Vec3 was_m = lights.places_world_m()[light];
    PlacedLights others = lights;
    others.drop(light);
    std::vector<Vec3> places_m;
    for (const Complement& c : candidates_.best(others, options_.complements, options_.apart_m))
      places_m.push_back(candidates_.place_world_m(c.candidate));
    std::mt19937_64 random(seed);
    std::normal_distribution<double> off_m(0, options_.near_m);
    for (std::size_t i = 0; i < options_.near_places; ++i) {
      const double x = off_m(random), y = off_m(random), z = off_m(random);
      const double nearer = i % 2 == 0 ? 1 : 0.2;
      places_m.push_back(was_m + nearer * Vec3(x, y, z));
    }
    std::vector<PlacedLights> ways;
    for (const Vec3& place_m : places_m) {
      PlacedLights way = others;
      ++trial.columns;
      if (way.add(place_m)) ways.push_back(std::move(way));
    }
    const std::size_t refined = std::min(kRefined, ways.size());
    std::partial_sort(ways.begin(), ways.begin() + static_cast<std::ptrdiff_t>(refined), ways.end(),
                      [](const PlacedLights& a, const PlacedLights& b) { return a.error() < b.error(); });
    for (std::size_t i = 0; i < refined && !options_.stop.stop_requested(); ++i) {
      trial.columns += refine_lights(ways[i], steps(kQuickSteps));
      if (!trial.lights || ways[i].error() < trial.lights->error()) trial.lights = std::move(ways[i]);
    }
    return trial;
  }

  /// One round: every light is taken out and put back, the best of these kept. False when none is better.
  bool improve(PlacedLights& lights, std::mt19937_64& random) {
    const std::uint64_t seed = random();
    std::vector<Trial> trials(lights.size());
    parallel_for(trials.size(), options_.threads,
                 [&](std::size_t light) { trials[light] = exchanged(lights, light, seed + light); });
    const Trial* best = nullptr;
    for (const Trial& trial : trials) {
      best_.columns += trial.columns;
      if (trial.lights && (!best || trial.lights->error() < best->lights->error())) best = &trial;
    }
    if (!best || !(best->lights->error() < kLeastProgress * lights.error())) return false;
    lights = *best->lights;
    best_.columns += refine_lights(lights, steps(RefineOptions{}.most_steps));
    return true;
  }

  static constexpr double kLeastProgress = 0.999;

  const ComplementSearch& candidates_;
  const PlaceOptions& options_;
  Placement best_;
};

}  // namespace

Placement place_lights(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
                       const PlaceOptions& options) {
  LUXRIG_CHECK(options.lights > 0, "{} lights", options.lights);
  return Search(light, goal, candidates, options).run();
}

}  // namespace luxrig
