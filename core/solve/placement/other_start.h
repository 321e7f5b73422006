#pragma once
/// Another way to begin a hard goal: from candidates that were annealed.
///
/// Lights added one by one share out a hard goal (an even floor with few lights, say) as the first of them happened to,
/// and exchanges that work out a column for every try mend it slowly. Candidates' columns are there: exchanging one for
/// another costs microseconds, so that a second of annealing over them (methods/anneal_candidates.h) tries some hundred
/// thousand. Where the goal can nearly be met the first way is as good, and does not pay for that.

#include <functional>
#include <optional>

#include "core/solve/placement/exchange_lights.h"

namespace luxrig {

/// Poses to begin with, for so many lights: about as many as these, or none; others for another seed.
using OtherStart = std::function<std::vector<LightPose>(std::size_t lights, std::uint64_t seed)>;

/// Above this error a search begins the other way, too.
inline constexpr double kHardGoalError = 0.1;

/// As many lights, begun from those and refined, or fewer where no more would gain; nothing when there are none, or
/// when it ended with too many still. none   no lights, of the problem that is solved
[[nodiscard]] std::optional<PlacedLights> begun_otherwise(LightExchange& exchange, const PlacedLights& none,
                                                          const OtherStart& other, std::size_t lights,
                                                          std::uint64_t seed, const std::function<bool()>& ended);

}  // namespace luxrig
