#pragma once
/// Error against power: the cost in error of each watt saved, with lights free to move and to be exchanged.

#include <memory>
#include <span>
#include <vector>

#include "core/solve/placement/search/exchange_lights.h"

namespace luxrig {

struct FrontPoint {
  std::unique_ptr<LightingGoal> goal;  ///< with this point's max_watts
  PlacedLights lights;
};

/// For each power limit, falling, the best lights found from those of the limit before (ε-constraint method: Haimes,
/// Lasdon & Wismer 1971). Errors rise along it.
///
/// start        lights to begin with
/// goal         with watts per emitter
/// max_watts    falling, ≥ 0
/// rounds       of exchanges at each point, at most
[[nodiscard]] std::vector<FrontPoint> energy_front(const MovableLight& light, const LightingGoal& goal,
                                                   const PlacedLights& start, std::span<const double> max_watts,
                                                   LightExchange& exchange, int rounds, std::uint64_t seed);

}  // namespace luxrig
