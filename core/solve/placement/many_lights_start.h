#pragma once
/// Another way to begin: from many lights, of which the least missed go until as many are left as are wanted.
///
/// Lights added one by one share out a hard goal (an even floor with few lights, say) as the first of them happened to;
/// exchanges then mend it slowly. (Where the number is open they are taken away again from more than are needed, which
/// does as well.) A cut through the light tree of GP16, which non-negative least squares over all
/// candidates has begun, knows of all points at once. Where the goal can nearly be met the first way is as good, and
/// does not pay for that.

#include <functional>
#include <optional>

#include "core/solve/placement/exchange_lights.h"

namespace luxrig {

/// Poses to begin with, for so many lights: some more than these, or none. It may take seconds.
using ManyLights = std::function<std::vector<LightPose>(std::size_t lights)>;

/// Above this error a search begins the other way, too.
inline constexpr double kHardGoalError = 0.1;

/// Rounds of exchanges (LightExchange::singly) as long as each takes a good share of the error away, and as long as one
/// more as good as the last would come below `to_beat`.
void exchange_roughly(LightExchange& exchange, PlacedLights& lights, double to_beat, const std::function<bool()>& ended,
                      std::mt19937_64& random);

/// As many lights, begun from those; nothing when these are none, or when it ended before it had them, or above
/// `to_beat`.
/// none   no lights, of the problem that is solved
[[nodiscard]] std::optional<PlacedLights> begun_from_many(LightExchange& exchange, const PlacedLights& none,
                                                          const ManyLights& many, std::size_t lights, double to_beat,
                                                          const std::function<bool()>& ended, std::mt19937_64& random);

}  // namespace luxrig
