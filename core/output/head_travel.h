#pragma once
/// Time a head needs from one posture to another.

#include <optional>

#include "core/rig/equipment.h"

namespace luxrig {

/// Seconds from its first movement until the fixture has arrived at `to`. The caller adds head_delay_s() before that.
/// Without `from`, the longest time from any posture.
[[nodiscard]] double travel_s(const Fixture& fixture, const std::optional<Joints>& from, const Joints& to);

/// Seconds after which it surely stands still, for who measures where it looks: a head on DMX may be a sixth slower than
/// stated, and swings at the end.
[[nodiscard]] double stands_still_s(const Fixture& fixture, const std::optional<Joints>& from, const Joints& to);

}  // namespace luxrig
