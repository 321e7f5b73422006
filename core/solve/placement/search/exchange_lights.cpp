#include "core/solve/placement/search/exchange_lights.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr int kQuickSteps = 4;       ///< of refinement, for lights that may be dropped again
constexpr std::size_t kRefined = 3;  ///< trial positions of a light that are refined
constexpr double kMinProgress = 0.999;

/// Pairs each light with the one that shares most light at the same points.
std::vector<std::pair<std::size_t, std::size_t>> neighbours(const PlacedLights& lights) {
  const Eigen::Index emitters = lights.emitters();
  Eigen::MatrixXd unit(lights.columns().rows(), static_cast<Eigen::Index>(lights.size()));
  for (Eigen::Index k = 0; k < unit.cols(); ++k)
    unit.col(k) = lights.columns().middleCols(k * emitters, emitters).rowwise().sum().normalized();
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

/// The best few, by rising error.
void keep_best_ways(std::vector<PlacedLights>& ways, std::size_t count) {
  count = std::min(count, ways.size());
  std::partial_sort(ways.begin(), ways.begin() + static_cast<std::ptrdiff_t>(count), ways.end(),
                    [](const PlacedLights& a, const PlacedLights& b) { return a.error() < b.error(); });
  ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(count), ways.end());
}

}  // namespace

RefineOptions LightExchange::steps(int most) const {
  RefineOptions refine;
  refine.max_steps = most;
  refine.longest_step_m = options_.longest_step_m;
  refine.stop = options_.watch.stop;
  return refine;
}

bool LightExchange::with_one_more(PlacedLights& lights, std::size_t choice, std::mt19937_64& random) {
  const auto found = candidates_.best(lights, choice, options_.apart_m);
  if (found.empty()) return false;
  const std::size_t taken = choice <= 1 ? 0 : std::uniform_int_distribution<std::size_t>(0, found.size() - 1)(random);
  ++columns_;
  if (!lights.add(candidates_.pose(found[taken].candidate))) return false;
  columns_ += refine_lights(lights, steps(2 * kQuickSteps));
  return true;
}

/// The lights without one of them, and the best replacement found.
LightExchange::Trial LightExchange::exchanged(const ComplementSearch::About& about, std::size_t light,
                                              std::uint64_t seed) const {
  const PlacedLights& lights = *about.lights;
  Trial trial;
  const LightPose was = lights.poses()[light];
  PlacedLights others = lights;
  others.drop(light);
  std::vector<LightPose> poses;
  for (const Complement& c : candidates_.best(about, {light}, others, options_.complements, options_.apart_m))
    poses.push_back(candidates_.pose(c.candidate));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> off(0, 1);
  for (std::size_t i = 0; i < options_.near_places; ++i) {
    Eigen::VectorXd step(lights.freedoms());
    for (Eigen::Index k = 0; k < step.size(); ++k)
      step[k] = (k < 3 ? options_.near_m : options_.near_rad) * off(random);
    constexpr double kNearer[] = {1, 0.25, 0.06};
    poses.push_back(moved(was, kNearer[i % 3] * step));
  }
  std::vector<PlacedLights> ways;
  for (const LightPose& pose : poses) {
    PlacedLights way = lights;
    ++trial.columns;
    if (way.replace(light, pose)) ways.push_back(std::move(way));
  }
  keep_best_ways(ways, kRefined);
  for (PlacedLights& way : ways) {
    if (options_.watch.stop.stop_requested()) break;
    trial.columns += refine_lights(way, steps(kQuickSteps));
    if (!trial.lights || way.error() < trial.lights->error()) trial.lights = std::move(way);
  }
  return trial;
}

bool LightExchange::singly(PlacedLights& lights, std::mt19937_64& random) {
  const std::uint64_t seed = random();
  const ComplementSearch::About about = candidates_.about(lights);
  std::vector<Trial> trials(lights.size());
  parallel_for(trials.size(), options_.threads,
               [&](std::size_t light) { trials[light] = exchanged(about, light, seed + light); });
  std::vector<std::size_t> better;
  for (std::size_t light = 0; light < trials.size(); ++light) {
    columns_ += trials[light].columns;
    if (trials[light].lights && trials[light].lights->error() < kMinProgress * lights.error()) better.push_back(light);
  }
  if (better.empty()) return false;
  std::sort(better.begin(), better.end(), [&](std::size_t a, std::size_t b) {
    const double of_a = trials[a].lights->error(), of_b = trials[b].lights->error();
    return of_a != of_b ? of_a < of_b : a < b;
  });
  lights = *trials[better.front()].lights;
  for (std::size_t i = 1; i < better.size(); ++i) {
    PlacedLights both = lights;
    ++columns_;
    if (both.replace(better[i], trials[better[i]].lights->poses()[better[i]]) &&
        both.error() < kMinProgress * lights.error())
      lights = std::move(both);
  }
  refine(lights);
  return true;
}

/// The lights without two of them, and the best replacements found: for the first one of the best complements, for the
/// second the best.
LightExchange::Trial LightExchange::pair_exchanged(const ComplementSearch::About& about,
                                                   std::pair<std::size_t, std::size_t> pair) const {
  Trial trial;
  PlacedLights others = *about.lights;
  others.drop(pair.second);
  others.drop(pair.first);
  for (const Complement& first :
       candidates_.best(about, {pair.first, pair.second}, others, options_.complements, options_.apart_m)) {
    if (options_.watch.stop.stop_requested()) break;
    PlacedLights way = others;
    ++trial.columns;
    if (!way.add(candidates_.pose(first.candidate))) continue;
    trial.columns += refine_lights(way, steps(kQuickSteps));
    const auto second = candidates_.best(way, 1, options_.apart_m);
    ++trial.columns;
    if (second.empty() || !way.add(candidates_.pose(second[0].candidate))) continue;
    trial.columns += refine_lights(way, steps(2 * kQuickSteps));
    if (!trial.lights || way.error() < trial.lights->error()) trial.lights = std::move(way);
  }
  return trial;
}

bool LightExchange::by_twos(PlacedLights& lights) {
  const auto pairs = neighbours(lights);
  const ComplementSearch::About about = candidates_.about(lights);
  std::vector<Trial> trials(pairs.size());
  parallel_for(trials.size(), options_.threads, [&](std::size_t i) { trials[i] = pair_exchanged(about, pairs[i]); });
  const Trial* best = nullptr;
  for (const Trial& trial : trials) {
    columns_ += trial.columns;
    if (trial.lights && (!best || trial.lights->error() < best->lights->error())) best = &trial;
  }
  if (!best || !(best->lights->error() < kMinProgress * lights.error())) return false;
  lights = *best->lights;
  refine(lights);
  return true;
}

bool LightExchange::through_more(PlacedLights& lights, std::size_t beyond, std::mt19937_64& random) {
  PlacedLights way = lights;
  while (way.size() < lights.size() + beyond && with_one_more(way, 1, random)) {
  }
  while (way.size() > lights.size() && !options_.watch.stop.stop_requested()) {
    way = without_one(way);
    singly(way, random);
  }
  if (way.size() > lights.size() || !(way.error() < kMinProgress * lights.error())) return false;
  lights = std::move(way);
  refine(lights);
  return true;
}

PlacedLights LightExchange::without_one(const PlacedLights& lights) {
  LUXRIG_CHECK(lights.size() > 0, "{} lights", lights.size());
  std::vector<PlacedLights> ways;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    ways.push_back(lights);
    ways.back().drop(light);
  }
  keep_best_ways(ways, kRefined);
  std::vector<std::size_t> columns(ways.size());
  parallel_for(ways.size(), options_.threads,
               [&](std::size_t i) { columns[i] = refine_lights(ways[i], steps(2 * kQuickSteps)); });
  columns_ += std::accumulate(columns.begin(), columns.end(), std::size_t{0});
  keep_best_ways(ways, 1);
  return std::move(ways.front());
}

}  // namespace luxrig
