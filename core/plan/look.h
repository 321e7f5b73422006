#pragma once
/// A look: the state of a rig. Levels, aims of heads, and goals at the points.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct Look {
  std::vector<double> levels;  ///< per fixture, 0…1
  std::vector<Joints> joints;  ///< per fixture
  /// Per point: the goal that corrections aim at; none = no goal.
  std::vector<std::optional<double>> goal_lx{};
  std::vector<std::optional<double>> max_lx{};  ///< per point; empty: the rig's
  std::vector<double> weight{};                 ///< per point; empty: the rig's
  /// Per fixture: the solved level, if a person wrote another one into the plan. The written level is then held by
  /// hand. Empty if no level was changed.
  std::vector<std::optional<double>> solved_levels{};
  std::vector<std::optional<Vec3>> aim_world_m{};  ///< per fixture: the aimed point, if known; empty if none is known
};

/// The aims of the rig file; no levels.
[[nodiscard]] inline Look hung_look(const Rig& rig) {
  Look look;
  for (const Fixture& fixture : rig.fixtures) {
    look.joints.push_back(fixture.joints);
    look.aim_world_m.push_back(fixture.aim_world_m);
  }
  return look;
}

/// The look being sent, and the fade to the safe look if no new command comes: passed from a daemon to its guardian and
/// back.
struct LightInForce {
  Look look;                           ///< levels and joints
  std::vector<double> safe_levels;     ///< per fixture, 0…1
  double hold_s = 0, fade_s = 0;       ///< remaining time to hold `look`, then the fade to `safe_levels`
  std::vector<std::uint8_t> silent{};  ///< per fixture, 1: not sent, as a desk drives it or may; empty: all are sent
};

}  // namespace luxrig
