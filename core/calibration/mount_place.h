#pragma once
/// Where a lamp that was found to hang elsewhere can hang.

#include "core/scene/ray_scene.h"

namespace luxrig {

/// An offset from the stated place that leads through a surface, moved back along that surface's normal to before it: a
/// lamp does not hang in a ceiling or behind a wall. In a corner it is shortened instead. Else the offset as it is.
/// offset_m   finite
[[nodiscard]] Vec3 offset_in_room(const RayScene& room, const Vec3& stated_world_m, const Vec3& offset_m);

}  // namespace luxrig
