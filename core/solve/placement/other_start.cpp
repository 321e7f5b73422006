#include "core/solve/placement/other_start.h"

namespace luxrig {

std::optional<PlacedLights> begun_otherwise(LightExchange& exchange, const PlacedLights& none, const OtherStart& other,
                                            std::size_t lights, std::uint64_t seed,
                                            const std::function<bool()>& ended) {
  const std::vector<LightPose> poses = other(lights, seed);
  std::mt19937_64 random(seed);
  PlacedLights begun = none;
  for (const LightPose& pose : poses) begun.add(pose);
  if (begun.size() == 0) return std::nullopt;
  exchange.refine(begun);
  while (begun.size() > lights && !ended()) begun = exchange.without_one(begun);
  while (begun.size() < lights && !ended() && exchange.with_one_more(begun, 1, random)) {
  }
  exchange.refine(begun);
  if (begun.size() > lights) return std::nullopt;
  return begun;
}

}  // namespace luxrig
