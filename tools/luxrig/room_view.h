#pragma once
/// The default camera.

#include "core/picture/picture.h"
#include "core/rig/rig.h"

namespace luxrig {

/// A view from the rim of the room, inside it, that shows most of the rig's points. In a rig without points it shows
/// most of the places that lamps and openings light first.
[[nodiscard]] Camera automatic_camera(const RayScene& scene, const Rig& rig, std::span<const Joints> joints,
                                      int width_px, int height_px, double vertical_fov_rad);

}  // namespace luxrig
