#include "tools/bench/cache/seen_part.h"

#include <gtest/gtest.h>

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig {
namespace {

TEST(SeenPart, CoversAWholeClosedScene) {
  const Scene scene = two_rooms(0.5);
  const RayScene rays(scene);
  const std::vector<Receiver> one = {{{1, 1, 0.5}, Vec3::UnitZ()}};
  const Eigen::AlignedBox3d part_m = seen_part_m(scene, rays, one, 1);
  EXPECT_EQ(part_m.min(), triangle_bounds_m(scene).min());
  EXPECT_EQ(part_m.max(), triangle_bounds_m(scene).max());
  EXPECT_TRUE(seen_part_m(Scene{}, RayScene(Scene{}), one, 1).isEmpty());
  EXPECT_EQ(seen_part_m(scene, rays, {}, 1).max(), part_m.max()) << "nobody looks";
  const std::vector<Receiver> outside = {{{1, 1, 50}, Vec3::UnitZ()}};
  EXPECT_EQ(seen_part_m(scene, rays, outside, 1).max(), part_m.max()) << "nothing is seen";
}

TEST(SeenPart, CoversTheRoomAndItsYardOnALargeGround) {
  const Scene scene = room_open_to_a_ground(1000, 0.5);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  for (double x = 0.5; x < 6; x += 1)
    for (double y = 0.5; y < 5; y += 1) receivers.push_back({{x, y, 0.8}, Vec3::UnitZ()});
  const Eigen::AlignedBox3d part_m = seen_part_m(scene, rays, receivers, 1);
  EXPECT_TRUE(part_m.contains(Vec3(0, 0, 0)) && part_m.contains(Vec3(6, 5, 2.7))) << part_m.min().transpose();
  EXPECT_LT(part_m.sizes().maxCoeff(), 20);
  // From outside, looking along the ground, more of it is seen.
  const std::vector<Receiver> outside = {{{3, -20, 1.6}, -Vec3::UnitY()}};
  EXPECT_GT(seen_part_m(scene, rays, outside, 1).sizes().maxCoeff(), 50);
}

}  // namespace
}  // namespace luxrig
