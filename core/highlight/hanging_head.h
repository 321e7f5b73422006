#pragma once
/// A luminaire that hangs somewhere and may pan, tilt, zoom and dim.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/rig/frames.h"

namespace luxrig {

struct HangingHead {
  Pose world_from_mount;  ///< base as hung; light leaves from the pivot
  double roll_rad = 0;
  bool moves = true;   ///< else it looks where `present` says, for ever
  PanTiltRange range;  ///< only when it moves
  PanTilt present;     ///< where it looks now
  double pan_speed_rad_s = rad_from_deg(180), tilt_speed_rad_s = rad_from_deg(120);  ///< > 0
  std::vector<Intensity> zoom;  ///< at rated flux, one per stop of its zoom; at least one
  double max_level = 1;         ///< 0…1
  double watts = 0;             ///< at full level
};

struct HeadSetting {
  PanTilt joints;
  std::size_t zoom = 0;  ///< index of HangingHead::zoom
  double level = 0;      ///< 0…1
};

/// Seconds until it looks there: both joints turn at once, each at its own speed.
[[nodiscard]] inline double travel_s(const HangingHead& head, const PanTilt& from, const PanTilt& to) {
  return std::max(std::abs(to.pan_rad - from.pan_rad) / head.pan_speed_rad_s,
                  std::abs(to.tilt_rad - from.tilt_rad) / head.tilt_speed_rad_s);
}

/// Its lamp, looking so.
[[nodiscard]] inline Pose lamp_pose(const HangingHead& head, const PanTilt& joints) {
  return world_from_lamp(head.world_from_mount, joints, head.roll_rad);
}

}  // namespace luxrig
