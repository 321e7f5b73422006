#pragma once
/// How long a head needs from one posture to another.

#include <optional>

#include "core/rig/rig.h"

namespace luxrig {

/// Seconds until a fixture that moves looks there, from its first movement on (kHeadDelay_s before that is the
/// caller's); wherever it looked before when that is not known.
[[nodiscard]] double travel_s(const Fixture& fixture, const std::optional<Joints>& from, const Joints& to);

}  // namespace luxrig
