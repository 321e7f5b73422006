/// daylight_through_openings: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "core/picture/picture.h"
#include "tests/core/transport/sky/daylight_through_openings_fixture.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/within.h"

namespace luxrig {
namespace {

using namespace daylight_through_openings_fixture;

TEST(DaylightThroughOpenings, IsTheSameForAnyNumberOfThreads) {
  const RoomWithWindows room = with_windows_that_face_each_other();
  const RayScene rays(room.scene());
  const auto emitters = under(make_overcast_sky(10'000));
  for (const bool path : {false, true}) {
    const auto evaluator = path ? make_path_evaluator(rays) : make_direct_evaluator(rays);
    EvaluateOptions options = within(0.05);
    options.threads = 1;
    const auto one = evaluated(*evaluator, room.desks(), emitters, options);
    options.threads = 2;
    const auto two = evaluated(*evaluator, room.desks(), emitters, options);
    EXPECT_EQ(one.lux_per_level, two.lux_per_level);
    EXPECT_EQ(one.replicates, two.replicates);
    EXPECT_EQ(one.rays, two.rays);
  }
}

}  // namespace
}  // namespace luxrig
