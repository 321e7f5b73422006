#pragma once
/// Another start for a hard goal: from annealed candidates.
///
/// Lights added one by one divide a hard goal (an even floor with few lights, for example) by the accident of the first
/// ones, and exchanges mend that slowly, since each try computes a column. Candidates already have columns: exchanging
/// them costs microseconds, so a second of annealing (methods/anneal_candidates.h) tries some hundred thousand. If the
/// goal can nearly be met, the first way is as good, and annealing does not pay off.

#include <functional>
#include <optional>

#include "core/solve/placement/search/exchange_lights.h"

namespace luxrig {

/// Poses to start from for this number of lights: about as many, or none; other seeds give others.
using OtherStart = std::function<std::vector<LightPose>(std::size_t lights, std::uint64_t seed)>;

/// Above this error a search also tries the other start.
inline constexpr double kHardGoalError = 0.1;

/// `lights` lights started from those poses and refined, or fewer if no more would gain. Empty if there are no poses,
/// or if it ended with too many lights.
/// none   an empty set of lights of the same problem
[[nodiscard]] std::optional<PlacedLights> begun_otherwise(LightExchange& exchange, const PlacedLights& none,
                                                          const OtherStart& other, std::size_t lights,
                                                          std::uint64_t seed, const std::function<bool()>& ended);

}  // namespace luxrig
