#pragma once
/// A mounted luminaire that may pan, tilt, zoom and dim.

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/rig/frames.h"

namespace luxrig {

/// One setting of a zoom.
struct ZoomStop {
  Intensity intensity;  ///< at rated flux
  double beam_rad = 0;  ///< its value in Joints
};

struct HangingHead {
  Pose world_from_mount;  ///< of the base as mounted; light leaves from the pivot
  double roll_rad = 0;
  bool moves = true;  ///< false = it always looks as in `present`
  JointRange range;   ///< only if it moves
  Joints present;     ///< its present aim
  double pan_speed_rad_s = rad_from_deg(180), tilt_speed_rad_s = rad_from_deg(120);  ///< > 0
  double zoom_speed_rad_s = rad_from_deg(30);                                        ///< > 0
  std::vector<ZoomStop> zoom;  ///< at least one; the first is the present one
  double max_level = 1;        ///< 0…1
  double watts = 0;            ///< at full level
  double reflected_lx = 0;     ///< by way of the room, everywhere on the object, at full level and whatever its aim
  /// Whether it may be lit with these joints; only if it moves. Empty = with any.
  std::function<bool(const Joints&)> may_light{};
};

struct HeadSetting {
  Joints joints;         ///< beam_rad matches `zoom`
  std::size_t zoom = 0;  ///< index of HangingHead::zoom
  double level = 0;      ///< 0…1
};

/// Seconds until the move ends: all joints turn at once, each at its own speed.
[[nodiscard]] inline double travel_s(const HangingHead& head, const Joints& from, const Joints& to) {
  return std::max({std::abs(to.pan_rad - from.pan_rad) / head.pan_speed_rad_s,
                   std::abs(to.tilt_rad - from.tilt_rad) / head.tilt_speed_rad_s,
                   std::abs(to.beam_rad - from.beam_rad) / head.zoom_speed_rad_s});
}

[[nodiscard]] inline bool may_light(const HangingHead& head, const Joints& joints) {
  return !head.moves || !head.may_light || head.may_light(joints);
}

/// Pose of its lamp with these joints.
[[nodiscard]] inline Pose lamp_pose(const HangingHead& head, const Joints& joints) {
  return world_from_lamp(head.world_from_mount, joints, head.roll_rad);
}

}  // namespace luxrig
