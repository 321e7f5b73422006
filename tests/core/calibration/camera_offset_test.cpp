#include "core/calibration/camera_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/picture/rig_camera.h"

namespace luxrig {
namespace {

Vec3 drawn(std::mt19937_64& random, double most) {
  std::uniform_real_distribution<double> any(-most, most);
  return {any(random), any(random), any(random)};
}

/// Both show the same places at the same pixels.
void expect_same_view(const Camera& a, const Camera& b) {
  EXPECT_TRUE(a.eye_world_m.isApprox(b.eye_world_m, 1e-12));
  for (const double x_px : {0.0, 300.0, 640.0})
    for (const double y_px : {0.0, 100.0, 400.0})
      EXPECT_LT((ray_direction(a, x_px, y_px) - ray_direction(b, x_px, y_px)).norm(), 1e-9) << x_px << ' ' << y_px;
}

TEST(CameraOffset, OfAnyCameraLeadsToIt) {
  std::mt19937_64 random(4);
  for (int k = 0; k < 300; ++k) {
    Camera from{drawn(random, 3), drawn(random, 3), 0.9, 640, 400};
    from.roll_rad = drawn(random, 0.5).x();
    from.distortion = drawn(random, 0.04).x();
    CameraOffset offset;
    offset << drawn(random, 0.3), drawn(random, 0.2), drawn(random, 0.05).x(), drawn(random, 0.03).x();
    const Camera to = offset_by(from, offset);
    EXPECT_LT((offset_between(from, to) - offset).norm(), 1e-9);
    expect_same_view(offset_by(from, offset_between(from, to)), to);
    EXPECT_LT(offset_between(from, from).norm(), 1e-9);
  }
}

// A quarter turn to the left about the vertical, and a roll that lowers the right side.
TEST(CameraOffset, TurnsAboutTheWorldsAxes) {
  Camera ahead;
  ahead.target_world_m = {0, 2, 0};
  CameraOffset left = CameraOffset::Zero();
  left[5] = kPi / 2;
  EXPECT_TRUE(offset_by(ahead, left).target_world_m.isApprox(Vec3(-2, 0, 0), 1e-12));
  CameraOffset about_its_axis = CameraOffset::Zero();
  about_its_axis[4] = 0.1;
  EXPECT_NEAR(offset_by(ahead, about_its_axis).roll_rad, 0.1, 1e-12);
}

TEST(CameraOffset, IsKeptByACalibrationWithItsErrors) {
  std::mt19937_64 random(5);
  PictureCamera camera;
  camera.position_world_m = {1, -2, 2};
  camera.aim_world_m = {0, 2, 1};
  CameraOffset offset;
  offset << 0.02, -0.03, 0.01, 0.01, -0.02, 0.005, 0.02, -0.01;
  const Camera found = offset_by(view_of(camera), offset);
  CameraCovariance covariance = CameraCovariance::Zero();
  covariance.diagonal() << 1e-6, 4e-6, 9e-6, 1e-8, 4e-8, 9e-8, 1e-6, 4e-6;
  CalibratedCamera kept;
  kept.name = "front";
  put_view(view_of(camera), found, covariance, kept);
  expect_same_view(view_of(camera, kept), found);
  EXPECT_NEAR(kept.offset_error_m.y(), 0.002, 1e-12);
  EXPECT_NEAR(kept.turn_error_deg.z(), deg_from_rad(3e-4), 1e-12);
  EXPECT_NEAR(kept.fov_deg.value, 40 * std::exp(0.02), 1e-9);
  EXPECT_NEAR(kept.fov_deg.standard_error, kept.fov_deg.value * 1e-3, 1e-12);
  EXPECT_NEAR(kept.distortion.standard_error, 2e-3, 1e-12);
}

}  // namespace
}  // namespace luxrig
