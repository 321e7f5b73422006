#include "sim/devices/camera.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace luxrig::sim
