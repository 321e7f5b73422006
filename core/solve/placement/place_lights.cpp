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
      while (!ended() && (improve(lights, random) || improve_pairs(lights))) offer(lights);
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
      constexpr double kNearer[] = {1, 0.25, 0.06};
      places_m.push_back(was_m + kNearer[i % 3] * Vec3(x, y, z));
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

  /// One round: every light is taken out and put back, the best of these kept, and of the others what improves that in
  /// turn: lights in rooms of their own do not wait for each other. False when none is better.
  bool improve(PlacedLights& lights, std::mt19937_64& random) {
    const std::uint64_t seed = random();
    std::vector<Trial> trials(lights.size());
    parallel_for(trials.size(), options_.threads,
                 [&](std::size_t light) { trials[light] = exchanged(lights, light, seed + light); });
    std::vector<std::size_t> better;
    for (std::size_t light = 0; light < trials.size(); ++light) {
      best_.columns += trials[light].columns;
      if (trials[light].lights && trials[light].lights->error() < kLeastProgress * lights.error())
        better.push_back(light);
    }
    if (better.empty()) return false;
    std::sort(better.begin(), better.end(), [&](std::size_t a, std::size_t b) {
      const double of_a = trials[a].lights->error(), of_b = trials[b].lights->error();
      return of_a != of_b ? of_a < of_b : a < b;
    });
    // A light that was taken out has come back as the last one: in its old place again, places compare by light.
    const auto in_place = [&](std::size_t light) {
      std::vector<Vec3> places_m = trials[light].lights->places_world_m();
      std::rotate(places_m.begin() + static_cast<std::ptrdiff_t>(light), places_m.end() - 1, places_m.end());
      return places_m;
    };
    std::vector<Vec3> places_m = in_place(better.front());
    lights.move(places_m);
    best_.columns += lights.size();
    for (std::size_t i = 1; i < better.size(); ++i) {
      PlacedLights both = lights;
      places_m = lights.places_world_m();
      places_m[better[i]] = in_place(better[i])[better[i]];
      both.move(places_m);
      ++best_.columns;
      if (both.error() < kLeastProgress * lights.error()) lights = std::move(both);
    }
    best_.columns += refine_lights(lights, steps(RefineOptions{}.most_steps));
    return true;
  }

  /// Each light with the one whose light falls most on the same points: two that stand in for each other's faults are
  /// in a basin that neither leaves alone.
  [[nodiscard]] static std::vector<std::pair<std::size_t, std::size_t>> neighbours(const PlacedLights& lights) {
    const Eigen::MatrixXd unit = lights.columns().colwise().normalized();
    Eigen::MatrixXd cosine = unit.transpose() * unit;
    cosine.diagonal().setConstant(-1);
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (Eigen::Index a = 0; a < cosine.cols(); ++a) {
      Eigen::Index b = 0;
      if (!(cosine.col(a).maxCoeff(&b) > 0)) continue;
      const std::pair<std::size_t, std::size_t> pair = {static_cast<std::size_t>(std::min(a, b)),
                                                        static_cast<std::size_t>(std::max(a, b))};
      if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
    }
    return pairs;
  }

  /// The lights without two of them, and the best found in their places: one of the best complements for the first,
  /// then the best for the second.
  Trial pair_exchanged(const PlacedLights& lights, std::pair<std::size_t, std::size_t> pair) const {
    Trial trial;
    PlacedLights others = lights;
    others.drop(pair.second);
    others.drop(pair.first);
    for (const Complement& first : candidates_.best(others, options_.complements, options_.apart_m)) {
      if (options_.stop.stop_requested()) break;
      PlacedLights way = others;
      ++trial.columns;
      if (!way.add(candidates_.place_world_m(first.candidate))) continue;
      trial.columns += refine_lights(way, steps(kQuickSteps));
      const auto second = candidates_.best(way, 1, options_.apart_m);
      ++trial.columns;
      if (second.empty() || !way.add(candidates_.place_world_m(second[0].candidate))) continue;
      trial.columns += refine_lights(way, steps(2 * kQuickSteps));
      if (!trial.lights || way.error() < trial.lights->error()) trial.lights = std::move(way);
    }
    return trial;
  }

  /// The same by twos, when one alone gets no further.
  bool improve_pairs(PlacedLights& lights) {
    const auto pairs = neighbours(lights);
    std::vector<Trial> trials(pairs.size());
    parallel_for(trials.size(), options_.threads, [&](std::size_t i) { trials[i] = pair_exchanged(lights, pairs[i]); });
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
