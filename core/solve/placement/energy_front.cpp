#include "core/solve/placement/energy_front.h"

#include "core/check.h"

namespace luxrig {
namespace {

PlacedLights hung_again(const MovableLight& light, const LightingGoal& goal, const PlacedLights& as) {
  PlacedLights lights(light, goal);
  for (const LightPose& pose : as.poses()) lights.add(pose);
  return lights;
}

}  // namespace

std::vector<FrontPoint> energy_front(const MovableLight& light, const LightingGoal& goal, const PlacedLights& start,
                                     std::span<const double> max_watts, LightExchange& exchange, int rounds,
                                     std::uint64_t seed) {
  LUXRIG_CHECK(goal.watts.size() == goal.emitters.cols(), "{} watts for {} emitters", goal.watts.size(),
               goal.emitters.cols());
  std::vector<FrontPoint> front;
  std::mt19937_64 random(seed);
  const PlacedLights* before = &start;
  for (const double watts : max_watts) {
    auto limited = std::make_unique<LightingGoal>(goal);
    limited->max_watts = watts;
    PlacedLights lights = hung_again(light, *limited, *before);
    exchange.refine(lights);
    for (int round = 0; round < rounds && exchange.singly(lights, random); ++round) {
    }
    front.push_back({std::move(limited), std::move(lights)});
    before = &front.back().lights;
  }
  // A result that is better with less power is also allowed with more.
  for (std::size_t i = front.size(); i-- > 1;)
    if (front[i].lights.error() < front[i - 1].lights.error())
      front[i - 1].lights = hung_again(light, *front[i - 1].goal, front[i].lights);
  return front;
}

}  // namespace luxrig
