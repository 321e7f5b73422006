#pragma once
/// Shared by the tests of picture.

#include "core/picture/picture.h"

namespace luxrig::picture_fixture {

inline Camera looking(const Vec3& eye_m, const Vec3& target_m) {
  Camera camera;
  camera.eye_world_m = eye_m;
  camera.target_world_m = target_m;
  camera.width_px = 33;
  camera.height_px = 21;
  return camera;
}

inline const std::vector<Emitter> kPictureBulb = {{make_isotropic(1000), {Mat3::Identity(), {0.2, 0.1, 0.3}}}};

}  // namespace luxrig::picture_fixture
