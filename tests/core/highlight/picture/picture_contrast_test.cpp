#include "core/highlight/picture/picture_contrast.h"

#include <gtest/gtest.h>

#include "tests/core/highlight/shapes.h"

namespace luxrig {
namespace {

/// Straight down on to a plane 2 m below; 40 pixels a metre there.
Camera camera_above() {
  Camera camera;
  camera.eye_world_m = {0, 0, 2};
  camera.target_world_m = Vec3::Zero();
  camera.width_px = camera.height_px = 80;
  camera.vertical_fov_rad = 2 * std::atan(0.5);
  return camera;
}

Picture painted(const std::function<double(int, int)>& cd_m2) {
  Picture picture;
  picture.width_px = picture.height_px = 80;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) picture.luminance_cd_m2.push_back(Vec3f::Constant(static_cast<float>(cd_m2(x, y))));
  return picture;
}

const OrientedPoint kMiddleOfPicture{{0, 0, 0}, Vec3::UnitZ()};

PictureContrast contrast_at_middle(const Picture& picture, double scale_m) {
  return picture_contrast(picture, camera_above(), RayScene(ceiling(5, 0)), std::span(&kMiddleOfPicture, 1), scale_m);
}

// Half of the pixels a, half b: deviation (a - b)/2 over the mean (a + b)/2.
TEST(PictureContrast, IsTheDeviationOverTheMeanAtAnyExposure) {
  for (const double exposure : {1e-3, 1.0, 1e5}) {
    const auto contrast = contrast_at_middle(painted([&](int x, int) { return exposure * (x < 40 ? 3 : 1); }), 0.1);
    EXPECT_EQ(contrast.seen, 1u);
    EXPECT_NEAR(contrast.local_contrast, 0.5, 1e-6);
    EXPECT_NEAR(contrast.mean_cd_m2, 2 * exposure, 1e-5 * exposure);
  }
  EXPECT_NEAR(contrast_at_middle(painted([](int, int) { return 7; }), 0.1).local_contrast, 0, 1e-6);
  EXPECT_EQ(contrast_at_middle(painted([](int, int) { return 0; }), 0.1).local_contrast, 0);
}

// 40 px a metre: 5 cm are 2 px to each side, and the edge is 6 px away.
TEST(PictureContrast, CoversPixelsWithinTheScale) {
  const Picture far_edge = painted([](int x, int) { return x < 34 ? 3 : 1; });
  EXPECT_NEAR(contrast_at_middle(far_edge, 0.05).local_contrast, 0, 1e-6);
  EXPECT_GT(contrast_at_middle(far_edge, 0.3).local_contrast, 0.2);
}

TEST(PictureContrast, CountsOnlyPointsThatTheCameraSees) {
  const RayScene plane(ceiling(5, 0)), covered(joined(ceiling(5, 0), ceiling(0.2, 1)));
  const Picture halves = painted([](int x, int) { return x < 40 ? 3 : 1; });
  const std::vector<OrientedPoint> points = {kMiddleOfPicture,
                                             {{0.1, 0, 0}, -Vec3::UnitZ()},  // faces away
                                             {{3, 0, 0}, Vec3::UnitZ()},     // beside the picture
                                             {{0, 0, 2.5}, Vec3::UnitZ()}};  // behind the camera
  EXPECT_EQ(picture_contrast(halves, camera_above(), plane, points, 0.1).seen, 1u);
  const auto hidden = picture_contrast(halves, camera_above(), covered, points, 0.1);
  EXPECT_EQ(hidden.seen, 0u);
  EXPECT_EQ(hidden.local_contrast, 0);
  EXPECT_EQ(picture_contrast(halves, camera_above(), plane, {}, 0.1).seen, 0u);
}

}  // namespace
}  // namespace luxrig
