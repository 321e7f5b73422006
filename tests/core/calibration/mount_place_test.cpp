#include "core/calibration/mount_place.h"

#include <gtest/gtest.h>

#include "tests/core/transport/boxes.h"
#include "tests/random.h"

namespace luxrig {
namespace {

/// A closed room from -2 to 2 m in x and y, 0 to 3 m in z.
RayScene room() {
  Scene scene;
  scene.materials = {Material{}};
  add_box(scene, {-2, -2, 0}, {2, 2, 3});
  return RayScene(scene);
}

TEST(MountPlace, IsLeftWhereNothingIsInTheWay) {
  const RayScene rays = room();
  const Vec3 offset_m(0.1, -0.05, 0.08);
  EXPECT_EQ(offset_in_room(rays, {0, 0, 2.9}, offset_m), offset_m);
  EXPECT_EQ(offset_in_room(rays, {0, 0, 2.9}, Vec3::Zero()), Vec3::Zero());
}

TEST(MountPlace, SlidesAlongTheCeilingThatItWouldPass) {
  const RayScene rays = room();
  const Vec3 offset_m = offset_in_room(rays, {0, 0, 2.9}, {-0.08, 0.03, 0.15});
  EXPECT_NEAR(offset_m.x(), -0.08, 1e-6);
  EXPECT_NEAR(offset_m.y(), 0.03, 1e-6);
  EXPECT_NEAR(offset_m.z(), 0.08, 1e-4) << "2 cm below the ceiling";
  // A lamp that is stated to be nearer stays as near.
  EXPECT_NEAR(offset_in_room(rays, {0, 0, 2.99}, {0.1, 0, 0.15}).z(), 0, 1e-4);
}

TEST(MountPlace, IsInTheRoomWhereverTheLampIsFound) {
  const RayScene rays = room();
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 stated_m(random.between(-1.99, 1.99), random.between(-1.99, 1.99), random.between(0.01, 2.99));
    const Vec3 wild_m(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const Vec3 at_m = stated_m + offset_in_room(rays, stated_m, wild_m);
    EXPECT_LT(at_m.head<2>().cwiseAbs().maxCoeff(), 2) << trial;
    EXPECT_GT(at_m.z(), 0) << trial;
    EXPECT_LT(at_m.z(), 3) << trial;
  }
}

}  // namespace
}  // namespace luxrig
