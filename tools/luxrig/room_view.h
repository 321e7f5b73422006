#pragma once
/// A camera for who names none.

#include "core/picture/picture.h"
#include "core/rig/rig.h"

namespace luxrig {

/// A view from the rim of the room, inside it, from which most of the rig's points are seen; where it has none, most of
/// what its lamps and openings light first.
[[nodiscard]] Camera automatic_camera(const RayScene& scene, const Rig& rig, int width_px, int height_px,
                                      double vertical_fov_rad);

}  // namespace luxrig
