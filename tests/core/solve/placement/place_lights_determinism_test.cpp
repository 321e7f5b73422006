/// place_lights: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/solve/placement/place_lights.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

TEST(PlaceLights, GivesTheSameBytesForAnyNumberOfThreads) {
  const LitHall hall(make_box_room(1), 0.4);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200)};
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  std::vector<Placement> got;
  for (const int threads : {1, 2, 8}) {
    PlaceOptions options;
    options.lights = 3;
    options.max_columns = 1500;
    options.exchange.threads = threads;
    got.push_back(place_lights(*hall.light, goal, candidates, options));
  }
  for (const Placement& other : got) {
    EXPECT_EQ(other.lights.poses(), got[0].lights.poses());
    EXPECT_EQ(other.lights.levels(), got[0].lights.levels());
    EXPECT_EQ(other.columns, got[0].columns);
  }
}

}  // namespace
}  // namespace luxrig
