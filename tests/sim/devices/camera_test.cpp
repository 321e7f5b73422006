#include "sim/devices/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/devices/camera_fixture.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace camera_fixture;

TEST(SimCamera, GivesTheSamePictureForTheSameShotAndBlackWithoutLight) {
  PhotographedRoom room;
  Shot shot;
  shot.threads = 1;
  const Picture one = room.taken({}, shot);
  shot.threads = 3;
  EXPECT_EQ(room.taken({}, shot).luminance_cd_m2, one.luminance_cd_m2);
  shot.number = 1;
  EXPECT_NE(room.taken({}, shot).luminance_cd_m2, one.luminance_cd_m2);
  room.light.levels = {0, 0, 0};
  for (const Vec3f& pixel : room.taken({}, shot).luminance_cd_m2) EXPECT_TRUE(pixel.isZero(0));
}

Picture even(int width_px, int height_px, float cd_m2) {
  Picture picture;
  picture.width_px = width_px;
  picture.height_px = height_px;
  picture.luminance_cd_m2.assign(static_cast<std::size_t>(width_px * height_px), Vec3f::Constant(cd_m2));
  return picture;
}

double sum_cd_m2(const Picture& picture) {
  double sum = 0;
  for (const Vec3f& pixel : picture.luminance_cd_m2) sum += static_cast<double>(pixel.y());
  return sum;
}

TEST(SimLens, LosesWhatItStatesInACornerAndNothingInTheMiddle) {
  CameraTruth truth;
  truth.corner_loss = 0.4;
  Picture picture = even(401, 301, 100);
  through_lens(truth, picture);
  EXPECT_NEAR(picture.luminance_cd_m2[150 * 401 + 200].y(), 100, 1e-3);
  EXPECT_NEAR(picture.luminance_cd_m2.front().y(), 60, 0.5);  // half a pixel before the corner
  EXPECT_NEAR(picture.luminance_cd_m2.back().y(), 60, 0.5);
}

TEST(SimLens, ScattersLightAndLosesNone) {
  CameraTruth truth;
  truth.flare = 0.02;
  truth.halo = 0.05;
  truth.halo_reach_px = 4;
  Picture picture = even(120, 80, 0);
  picture.luminance_cd_m2[40 * 120 + 60].setConstant(9600);  // one for each pixel
  picture.luminance_cd_m2[0].setConstant(9600);
  through_lens(truth, picture);
  EXPECT_NEAR(sum_cd_m2(picture), 2 * 9600, 1);
  EXPECT_NEAR(picture.luminance_cd_m2[70 * 120 + 110].y(), 2 * 0.02, 1e-4) << "the veil alone";
  // Halo: the variance along x of what is above the veil, without the bright pixel itself.
  double light = 0, moment = 0;
  for (int y = 20; y < 60; ++y)
    for (int x = 40; x < 80; ++x) {
      double cd_m2 = static_cast<double>(picture.luminance_cd_m2[static_cast<std::size_t>(y * 120 + x)].y()) - 2 * 0.02;
      if (x == 60 && y == 40) cd_m2 -= 0.93 * 9600;
      light += cd_m2;
      moment += cd_m2 * (x - 60) * (x - 60);
    }
  EXPECT_NEAR(light, 0.05 * 9600, 5);
  EXPECT_NEAR(std::sqrt(moment / light), 4, 0.6);
}

TEST(SimCamera, SeesEachKindOfLampByItsOwnFactorAndWithoutDeviationsAsTheEye) {
  PhotographedRoom room;
  Shot shot;
  shot.passes = 2;
  const CameraTruth stated = draw_camera(room.rig, room.camera, 0, Deviations::none());
  const auto seen = [&](const CameraTruth& truth) {
    const auto light = light_on_sensor(room.room, room.rig, room.truths, room.light, truth, shot);
    EXPECT_TRUE(light);
    return sum_cd_m2(*light);
  };
  CameraTruth sees_more = stated;
  sees_more.response.assign(room.rig.luminaires.size() + 1, 1.5);
  EXPECT_NEAR(seen(sees_more), 1.5 * seen(stated), 1e-3 * seen(stated));
  EXPECT_TRUE(draw_camera(room.rig, room.camera, 0, Deviations{}).response.empty()) << "mild: as the eye";
}

TEST(SimCamera, IsDrawnFromTheSeedWithinWhatTheDeviationsSay) {
  const PhotographedRoom room;
  Deviations real = Deviations::real();
  double most_rad = 0, most_m = 0, most_loss = 0;
  for (real.seed = 1; real.seed <= 200; ++real.seed) {
    const CameraTruth truth = draw_camera(room.rig, room.camera, 0, real);
    const Vec3 stated = (room.camera.aim_world_m - room.camera.position_world_m).normalized();
    const Vec3 ahead = (truth.view.target_world_m - truth.view.eye_world_m).normalized();
    most_rad = std::max(most_rad, std::hypot(std::acos(std::min(1.0, stated.dot(ahead))), truth.view.roll_rad));
    most_m = std::max(most_m, (truth.view.eye_world_m - room.camera.position_world_m).norm());
    most_loss = std::max(most_loss, truth.corner_loss);
    for (const double factor : truth.response) EXPECT_LE(std::abs(std::log(factor)), real.camera_log_response);
  }
  EXPECT_LE(most_rad, real.camera_angle_rad * 1.0001);
  EXPECT_GT(most_rad, 0.8 * real.camera_angle_rad);
  EXPECT_LE(most_m, real.camera_position_m);
  EXPECT_GT(most_m, 0.8 * real.camera_position_m);
  EXPECT_LE(most_loss, 0.5);
  EXPECT_GT(most_loss, 0.48);
}

}  // namespace
}  // namespace luxrig::sim
