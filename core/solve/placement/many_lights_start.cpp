#include "core/solve/placement/many_lights_start.h"

namespace luxrig {
namespace {

/// Share of the error that a rough round takes away, or is the last.
constexpr double kRoughProgress = 0.03;

}  // namespace

void exchange_roughly(LightExchange& exchange, PlacedLights& lights, double to_beat, const std::function<bool()>& ended,
                      std::mt19937_64& random) {
  while (!ended()) {
    const double was = lights.error();
    if (!exchange.singly(lights, random)) return;
    const double gain = was - lights.error();
    if (gain < kRoughProgress * was || lights.error() - gain > to_beat) return;
  }
}

std::optional<PlacedLights> begun_from_many(LightExchange& exchange, const PlacedLights& none, const ManyLights& many,
                                            std::size_t lights, double to_beat, const std::function<bool()>& ended,
                                            std::mt19937_64& random) {
  const std::vector<LightPose> poses = many(lights);
  PlacedLights begun = none;
  for (const LightPose& pose : poses) begun.add(pose);
  if (begun.size() == 0) return std::nullopt;
  exchange.refine(begun);
  while (begun.size() > lights && !ended()) begun = exchange.without_one(begun);
  while (begun.size() < lights && !ended() && exchange.with_one_more(begun, 1, random)) {
  }
  exchange.refine(begun);
  exchange_roughly(exchange, begun, to_beat, ended, random);
  if (begun.size() > lights || !(begun.error() < to_beat)) return std::nullopt;
  return begun;
}

}  // namespace luxrig
