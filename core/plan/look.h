#pragma once
/// A look: the one state of a rig. Levels, where heads look, and what is asked at the points.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

struct Look {
  std::vector<double> levels;  ///< per fixture, 0…1
  std::vector<Joints> joints;  ///< per fixture
  /// Per point: what corrections aim at. None: nothing.
  std::vector<std::optional<double>> goal_lx{};
  std::vector<std::optional<double>> max_lx{};  ///< per point; empty: the rig's
  std::vector<double> weight{};                 ///< per point; empty: the rig's
  /// Per fixture: the solved level, where a person wrote another one into the plan. That one is then held by hand.
  /// Empty: nobody did.
  std::vector<std::optional<double>> solved_levels{};
  std::vector<std::optional<Vec3>> aim_world_m{};  ///< per fixture: the point it looks at, if known; empty: none is
};

/// Where fixtures look by the rig file; no levels.
[[nodiscard]] inline Look hung_look(const Rig& rig) {
  Look look;
  for (const Fixture& fixture : rig.fixtures) {
    look.joints.push_back(fixture.joints);
    look.aim_world_m.push_back(fixture.aim_world_m);
  }
  return look;
}

/// A look that is sent, and the way to the safe look if nobody does anything: from a daemon to its guardian and back.
struct LightInForce {
  Look look;                           ///< levels and joints
  std::vector<double> safe_levels;     ///< per fixture, 0…1
  double hold_s = 0, fade_s = 0;       ///< how long `look` is still held, and the fade from there to `safe_levels`
  std::vector<std::uint8_t> silent{};  ///< per fixture, 1: not sent, since a desk drives it or may; empty: all are
};

}  // namespace luxrig
