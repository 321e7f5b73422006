#include "core/calibration/camera_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

using namespace box_room;

/// Off by up to 1° and 3 cm, with a lens of its own.
Camera true_camera(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> drawn(-1, 1);
  Camera camera = stated_camera();
  for (int axis = 0; axis < 3; ++axis) camera.eye_world_m[axis] += 0.017 * drawn(random);
  camera.target_world_m = camera.eye_world_m + (stated_camera().target_world_m - stated_camera().eye_world_m);
  camera.target_world_m += 0.06 * Vec3(drawn(random), 0, drawn(random));
  camera.roll_rad = 0.01 * drawn(random);
  camera.vertical_fov_rad *= 1 + 0.02 * drawn(random);
  camera.distortion = 0.02 * drawn(random);
  return camera;
}

/// Distances between where two cameras show what the first sees, over the picture.
std::vector<double> apart_px(const RayScene& rays, const Camera& a, const Camera& b) {
  std::vector<double> apart;
  for (int y = 10; y < a.height_px; y += 20)
    for (int x = 10; x < a.width_px; x += 20) {
      const auto hit = rays.nearest(a.eye_world_m, ray_direction(a, x, y), Vec3::Zero());
      const auto place = pixel_of(b, hit->position_world_m);
      if (place) apart.push_back(std::hypot(place->x_px - x, place->y_px - y));
    }
  std::sort(apart.begin(), apart.end());
  return apart;
}

TEST(CameraPose, IsFoundFromEdgesOfTheRoomWithinItsStatedError) {
  const RayScene rays(room_with_boxes());
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Camera truth = true_camera(seed);
    const auto found = find_camera(rays, stated_camera(), seen_by(rays, truth, 0.02, seed));
    ASSERT_TRUE(found) << found.error().detail;
    const auto before = apart_px(rays, truth, stated_camera()), after = apart_px(rays, truth, found->camera);
    std::printf("seed %d: %.2f px before, %.2f px after, worst %.2f, stated %.2f, held out %.2f, %zu edges\n",
                static_cast<int>(seed), before[before.size() / 2], after[after.size() / 2], after.back(),
                found->standard_error_px, found->off_px, found->edges);
    EXPECT_LT(after[after.size() / 2], 0.2);
    EXPECT_LT(after.back(), 1);
    EXPECT_LT(after[after.size() / 2], 3 * found->standard_error_px);
    EXPECT_LT(found->off_px, 0.3);
  }
}

// The sum of squares over a camera's eight numbers, each in its stated standard errors, is 8 on average where these are
// independent. A pose and its turn are not, but each is as wide as stated by itself.
TEST(CameraPose, EachOfItsNumbersIsWithinItsStatedErrors) {
  const RayScene rays(room_with_boxes());
  double squares = 0, count = 0;
  for (std::uint64_t seed = 11; seed <= 16; ++seed) {
    const Camera truth = true_camera(seed);
    const auto found = find_camera(rays, stated_camera(), seen_by(rays, truth, 0.02, seed));
    ASSERT_TRUE(found) << found.error().detail;
    const CameraOffset off = offset_between(found->camera, truth);
    const CameraOffset error = found->covariance.diagonal().cwiseSqrt();
    for (Eigen::Index k = 0; k < kCameraUnknowns; ++k) {
      EXPECT_GT(error[k], 0);
      EXPECT_LT(std::abs(off[k]), 4 * error[k]) << "number " << k << ", seed " << seed;
      squares += std::pow(off[k] / error[k], 2), ++count;
    }
    EXPECT_LT(error.head<3>().norm(), 0.03) << "it is worth to be told";
    EXPECT_LT(error.segment<3>(3).norm(), 0.01);
  }
  std::printf("squares of errors over those stated: %.2f on average\n", squares / count);
  EXPECT_LT(squares / count, 2);
}

TEST(CameraPose, OfTheStatedCameraIsTheStatedCamera) {
  const RayScene rays(room_with_boxes());
  const auto found = find_camera(rays, stated_camera(), seen_by(rays, stated_camera(), 0, 1));
  ASSERT_TRUE(found) << found.error().detail;
  EXPECT_LT(apart_px(rays, stated_camera(), found->camera).back(), 0.3);
  EXPECT_LT(found->stated_off_px, 0.1);
}

TEST(CameraPose, IsRefusedWhenThePictureDoesNotTellIt) {
  const RayScene rays(room_with_boxes());
  const auto words_for = [&](const RayScene& scene, const Camera& stated, const Picture& picture) {
    const auto found = find_camera(scene, stated, picture);
    return found ? "found" : found.error().detail;
  };
  const Camera stated = stated_camera();
  Picture black = seen_by(rays, stated, 0, 1);
  for (Vec3f& pixel : black.luminance_cd_m2) pixel.setZero();
  EXPECT_NE(words_for(rays, stated, black).find("light more of the room"), std::string::npos);

  Picture noise = black;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> any(0, 1);
  for (Vec3f& pixel : noise.luminance_cd_m2) pixel.setConstant(any(random));
  EXPECT_NE(words_for(rays, stated, noise), "found");

  Camera elsewhere = stated;  // another view altogether
  elsewhere.eye_world_m = {2.5, -2.5, 1.2};
  elsewhere.target_world_m = {-3, 1.5, 1.4};
  EXPECT_NE(words_for(rays, stated, seen_by(rays, elsewhere, 0.01, 1)), "found");

  Scene bare;
  bare.object_names = {"scene"};
  add_box(bare, {-4, -3, 0}, {4, 3, 3}, 0.6);
  const RayScene wall(bare);
  Camera at_wall = stated;  // sees nothing but one wall
  at_wall.eye_world_m = {0, 1.5, 1.5};
  at_wall.target_world_m = {0, 3, 1.5};
  at_wall.vertical_fov_rad = 0.6;
  EXPECT_NE(words_for(wall, at_wall, seen_by(wall, at_wall, 0.01, 1)).find("edges of the scene at 0 places"),
            std::string::npos);
}

}  // namespace
}  // namespace luxrig
