/// place_in_scene: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/solve/placement/scene/place_in_scene.h"
#include "tests/core/solve/placement/place_in_scene_fixture.h"

namespace luxrig {
namespace {

using namespace place_in_scene_fixture;

TEST(PlaceInScene, IsTheSameForAnyNumberOfThreads) {
  const LitFloor room;
  LightingGoal even = room.goal_of(kThree);
  even.lux.setConstant(100);
  std::vector<PlacedInScene> found;
  for (const int threads : {1, 3}) {
    PlaceInSceneOptions options = direct_light();
    options.max_lights = 2;
    options.threads = threads;
    found.push_back(*room.place(even, options));
  }
  ASSERT_EQ(found[0].lights.size(), found[1].lights.size());
  EXPECT_EQ(found[0].error, found[1].error);
  for (std::size_t i = 0; i < found[0].lights.size(); ++i)
    EXPECT_EQ(found[0].lights[i].position_world_m, found[1].lights[i].position_world_m);
}

}  // namespace
}  // namespace luxrig
