#pragma once
/// Another way to begin a hard goal: from candidates that were annealed.
///
/// Lights added one by one share out a hard goal (an even floor with few lights, say) as the first of them happened to,
/// and exchanges that work out a column for every try mend it slowly. Candidates' columns are there: exchanging one for
/// another costs microseconds (methods/anneal_candidates.h). Where the number is open (choose_lights.h), lights are
/// taken away again from more than are needed, which does nearly as well in half the time; where the goal can nearly be
/// met the first way is as good, and does not pay for that.

#include <functional>
#include <optional>

#include "core/solve/placement/exchange_lights.h"

namespace luxrig {

/// Poses to begin with, for so many lights: about as many as these, or none. It may take seconds.
using OtherStart = std::function<std::vector<LightPose>(std::size_t lights)>;

/// Above this error a search begins the other way, too.
inline constexpr double kHardGoalError = 0.1;

/// As many lights, begun from those and refined; nothing when there are none, or when it ended before it had as many.
/// none   no lights, of the problem that is solved
[[nodiscard]] std::optional<PlacedLights> begun_otherwise(LightExchange& exchange, const PlacedLights& none,
                                                          const OtherStart& other, std::size_t lights,
                                                          const std::function<bool()>& ended, std::mt19937_64& random);

}  // namespace luxrig
