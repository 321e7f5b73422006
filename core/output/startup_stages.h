#pragma once
/// How light comes on after power-up, so that lamps do not all strike at once. Each fixture has a ceiling that rises
/// from 0 to 1 from a given instant. It applies to every source of levels, including a desk. Reductions of light never
/// wait.

#include <cstdint>
#include <span>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct LampStart {
  Time begin{};     ///< dark until then
  Duration rise{};  ///< until the ceiling is 1; linear in level
  double held = 0;  ///< 0…1: level that it already has and keeps
  /// 0…1, of its max_level.
  [[nodiscard]] double ceiling(Time now) const;
};

/// Per fixture; empty = nothing is staged.
using LampStarts = std::vector<LampStart>;

/// The starts of fixtures after power comes at `power`. starts: per fixture of the rig, 1 = it starts.
///
/// Stages run in order of their numbers, each stage_s after the one before. Within a stage, all rise together over
/// fade_s of [control]. With max_watts_per_s, a stage also waits until the one before is done. Its fixtures then rise
/// one after the other, in order of the rig file, each over max_level · watts / max_watts_per_s. No two rises overlap,
/// so power never rises faster than that. A head is also dark for its reset_s.
///
/// not_before: no rise begins earlier (others are still rising, or heads are turning).
/// burning: per fixture, 0…1 of its max_level; may be empty. Those above 0 had already begun. They form a stage before
/// all others, never fall below that level, and continue to rise from there.
[[nodiscard]] LampStarts lamp_starts(const Rig& rig, std::span<const double> max_level,
                                     std::span<const std::uint8_t> starts, Time power, Time not_before,
                                     std::span<const double> burning = {});

/// When the last of them is done; Time{} if there are none. Lamps without power do not count.
[[nodiscard]] Time all_up(const LampStarts& lamps);
/// Start of a lamp that has no power.
inline constexpr Time kWithoutPower = Time::max();

/// Whether [startup] asks for light to come on by stages.
[[nodiscard]] inline bool staged(const StartupSpec& startup) {
  return startup.stage_s > 0 || startup.max_watts_per_s.has_value();
}

}  // namespace luxrig
