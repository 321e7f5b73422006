/// placement_methods: the same for any number of threads.
#include <gtest/gtest.h>

#include <optional>

#include "tests/core/solve/placement/lit_hall.h"
#include "tests/core/solve/placement/placement_methods_fixture.h"
#include "tools/bench/methods/compared_methods.h"

namespace luxrig {
namespace {

using namespace placement_methods_fixture;

TEST(PlacementMethods, GiveTheSameForASeedAndAnyNumberOfThreads) {
  const LitHall hall(make_box_room(1), kHallLattice_m);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200), {}};
  for (const PlacementMethod& method : compared_methods()) {
    std::optional<FoundLights> first;
    for (const int threads : {1, 3}) {
      PlacementOptions options = options_of(method, 3);
      options.max_columns = 1500;
      options.iterations = 200;
      options.starts = 3;
      options.threads = threads;
      auto got = method.run(problem_of(hall, goal), options);
      ASSERT_TRUE(got.has_value());
      if (!first) {
        first = std::move(*got);
        continue;
      }
      EXPECT_EQ(got->lights.poses(), first->lights.poses()) << method.name;
      EXPECT_EQ(got->lights.levels(), first->lights.levels()) << method.name;
      EXPECT_EQ(got->columns, first->columns) << method.name;
    }
  }
}

}  // namespace
}  // namespace luxrig
