/// sky_openings: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/transport/sky/sky_openings.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/sky/sky_openings_fixture.h"

namespace luxrig {
namespace {

using namespace sky_openings_fixture;

TEST(SkyOpenings, AreTheSameForAnyNumberOfThreads) {
  RoomWithWindows room;
  room.near_window_m = {1, 3, 1, 2};
  std::uint64_t rays_of_one = 0, rays_of_two = 0;
  const SkyOpenings one = found(room, 5, &rays_of_one, 1), two = found(room, 5, &rays_of_two, 2);
  ASSERT_EQ(one.openings().size(), two.openings().size());
  EXPECT_EQ(rays_of_one, rays_of_two);
  EXPECT_EQ(one.missed_share(), two.missed_share());
  for (std::size_t i = 0; i < one.openings().size(); ++i) {
    EXPECT_EQ(one.openings()[i].centre_world_m, two.openings()[i].centre_world_m);
    EXPECT_EQ(one.openings()[i].half_x_m, two.openings()[i].half_x_m);
    EXPECT_EQ(one.openings()[i].half_y_m, two.openings()[i].half_y_m);
  }
}

}  // namespace
}  // namespace luxrig
