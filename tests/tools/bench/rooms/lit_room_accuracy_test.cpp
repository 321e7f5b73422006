/// lit_room: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/transport/candidates/air_regions.h"
#include "tests/tools/bench/rooms/lit_room_fixture.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace lit_room_fixture;

INSTANTIATE_TEST_SUITE_P(All, LitRooms, testing::ValuesIn(kRooms), [](const auto& of) { return of.param.name; });

// Receivers and lamps share one air region, also for seeds unlike those inspected by hand.
TEST_P(LitRooms, HaveConnectedReceiversAndLampsForAnySeed) {
  for (const std::uint64_t seed : {0ULL, ~0ULL, 1ULL << 63, 0x5555555555555555ULL}) {
    const LitRoom room = GetParam().make(seed);
    EXPECT_EQ(room.receivers.size(), GetParam().receivers);
    const AirRegions regions(room.scene);
    const std::uint64_t air = regions.mark(room.emitters.front().world_from_lamp.translation_m);
    for (const Receiver& r : room.receivers) ASSERT_EQ(regions.mark(r.position_world_m), air);
    for (const Emitter& e : room.emitters) {
      ASSERT_EQ(regions.mark(e.world_from_lamp.translation_m), air);
      EXPECT_TRUE(room.interior_m.contains(e.world_from_lamp.translation_m));
    }
    for (std::size_t a = 0; a < room.regions_m.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_LT(room.regions_m[a].intersection(room.regions_m[b]).sizes().minCoeff(), 1e-9);
  }
}

/// Number of solids around the point: crossings of a ray, each with the sign of the side it comes from.
int solids_around(const Scene& scene, const Vec3& point_m) {
  const Vec3 towards = Vec3(0.3217, 0.5419, 0.7764).normalized();
  int count = 0;
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertex_world_m(t[0]) - point_m, b = scene.vertex_world_m(t[1]) - point_m,
               c = scene.vertex_world_m(t[2]) - point_m;
    const double u = towards.dot(c.cross(b)), v = towards.dot(a.cross(c)), w = towards.dot(b.cross(a));
    const bool leaving = u <= 0 && v <= 0 && w <= 0, entering = u >= 0 && v >= 0 && w >= 0;
    if (!leaving && !entering) continue;
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.dot(a) * normal.dot(towards) <= 0) continue;  // behind the point, or in the ray's plane
    count += normal.dot(towards) > 0 ? 1 : -1;
  }
  return count;
}

TEST_P(LitRooms, HaveReceiversAndLampsInFreeSpace) {
  for (const std::uint64_t seed : {1, 2}) {
    const LitRoom room = GetParam().make(seed);
    // Brute force: in large rooms only some receivers. AirRegions checks all of them above.
    const std::size_t step = 1 + room.scene.triangles.size() / 20'000;
    for (std::size_t i = 0; i < room.receivers.size(); i += step) {
      const Receiver& r = room.receivers[i];
      EXPECT_NEAR(r.normal_world.norm(), 1, 1e-12);
      ASSERT_EQ(solids_around(room.scene, r.position_world_m), 0) << r.position_world_m.transpose();
    }
    for (const Emitter& e : room.emitters) ASSERT_EQ(solids_around(room.scene, e.world_from_lamp.translation_m), 0);
  }
  // Check of the count itself: a point at z = -0.1 m is in the floor's slab.
  const LitRoom room = GetParam().make(1);
  EXPECT_GT(solids_around(room.scene, {1.234, 1.111, -0.1}), 0);
}

}  // namespace
}  // namespace luxrig
