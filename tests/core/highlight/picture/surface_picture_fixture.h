#pragma once
/// Shared by the tests of surface_picture.

#include <gtest/gtest.h>

#include <cmath>

#include "core/highlight/picture/object_view.h"
#include "core/highlight/picture/surface_picture.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig::surface_picture_fixture {

inline const Vec3f kWhitePaper = Vec3f::Ones(), kGreyPlate = Vec3f::Constant(0.5f), kRedDisc(1, 0, 0);

inline Camera before_the_plate() {
  Camera camera;
  camera.eye_world_m = Vec3(0, -2, 0);
  camera.target_world_m = Vec3::Zero();
  camera.width_px = 200;
  camera.height_px = 160;
  camera.vertical_fov_rad = 2 * std::atan(0.8 / 2);
  return camera;
}

inline SurfacePicture picture_of(const Scene& scene, int samples_per_edge, double near_m = 0, int threads = 1) {
  SurfacePicture picture(before_the_plate(), samples_per_edge, near_m, kWhitePaper);
  EXPECT_TRUE(picture.draw(RayScene(scene), [](const Hit&, const Vec3&) { return kGreyPlate; }, threads, {}));
  return picture;
}

}  // namespace luxrig::surface_picture_fixture
