#pragma once
/// How light comes on after power does, so that lamps do not all strike in one instant: for each fixture a ceiling that
/// rises from 0 to 1 from a certain instant on. Whatever wants the light is under it, a desk too; what takes light away
/// never waits.

#include <cstdint>
#include <span>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct LampStart {
  Time begin{};     ///< dark until then
  Duration rise{};  ///< and all that it may have from then and this on; linear in level between
  double held = 0;  ///< 0…1: what it has already, and keeps
  /// 0…1, of its max_level.
  [[nodiscard]] double ceiling(Time now) const;
};

/// Per fixture; empty: nothing is staged.
using LampStarts = std::vector<LampStart>;

/// The starts of these fixtures (1 of each that starts, per fixture of the rig) when power comes at `power`.
///
/// Stage n, in order of number, begins stage_s after the one before it, and with max_watts_per_s not before that one is
/// done: its fixtures then rise one after the other, in order of the rig file, each over max_level · watts /
/// max_watts_per_s. Without, all of a stage rise together over fade_s of [control]. A head is also dark for its
/// reset_s. not_before: nobody of them begins earlier (others are still rising, or heads turn). No two rises overlap
/// where watts are limited, so that at no time more is added than that.
///
/// burning: per fixture, 0…1 of its max_level; may be empty. Those above 0 had begun before: they are of a stage before
/// all others, are never below that, and rise from there as they would have gone on.
[[nodiscard]] LampStarts lamp_starts(const Rig& rig, std::span<const double> max_level,
                                     std::span<const std::uint8_t> starts, Time power, Time not_before,
                                     std::span<const double> burning = {});

/// When the last of them is done; Time{} when there are none. Lamps without power do not count.
[[nodiscard]] Time all_up(const LampStarts& lamps);
/// Of a lamp that has no power.
inline constexpr Time kWithoutPower = Time::max();

/// Something in [startup] says that light comes on by stages.
[[nodiscard]] inline bool staged(const StartupSpec& startup) {
  return startup.stage_s > 0 || startup.max_watts_per_s.has_value();
}

}  // namespace luxrig
