/// surface_sides: the same for any number of threads.
#include <gtest/gtest.h>

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/surface_sides_fixture.h"
#include "tools/bench/cache/surface_sides.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace surface_sides_fixture;

TEST(SurfaceSides, DoNotDependOnTheNumberOfThreads) {
  const Scene scene = make_box_room().scene;
  const RayScene rays(scene);
  const SurfaceSides one = sides_of(scene, rays, 32, 4, 1), many = sides_of(scene, rays, 32, 4, 5);
  ASSERT_EQ(one.pieces().size(), many.pieces().size());
  ASSERT_EQ(one.groups(), many.groups());
  for (std::size_t i = 0; i < one.pieces().size(); ++i) {
    EXPECT_EQ(one.pieces()[i].side, many.pieces()[i].side);
    EXPECT_EQ(one.pieces()[i].position_world_m, many.pieces()[i].position_world_m);
  }
}

}  // namespace
}  // namespace luxrig
