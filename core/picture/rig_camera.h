#pragma once
/// Converts a camera of the rig to a picture camera.

#include "core/picture/picture.h"
#include "core/rig/equipment.h"

namespace luxrig {

[[nodiscard]] inline Camera view_of(const PictureCamera& camera) {
  return {camera.position_world_m, camera.aim_world_m, camera.vertical_fov_rad, camera.width_px, camera.height_px};
}

}  // namespace luxrig
