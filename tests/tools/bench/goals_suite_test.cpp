#include <gtest/gtest.h>

#include "tools/bench/goals/canvas.h"
#include "tools/bench/goals/tiled_hall.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

TEST(GoalsSuite, TheHallHasAsManyTrianglesAsWantedAndTheAreaOfItsPlan) {
  // Floor, ceiling, walls, 32 shafts. With so many triangles these are round.
  const double wanted_m2 = 2 * (24 * 12 + 24 * 5 + 12 * 5) + 32 * 2 * kPi * 0.35 * 5;
  for (const std::size_t triangles : {100'000, 300'000}) {
    const Scene scene = make_tiled_hall(triangles);
    EXPECT_NEAR(static_cast<double>(scene.triangles.size()), static_cast<double>(triangles),
                0.02 * static_cast<double>(triangles));
    double area_m2 = 0;
    for (const auto& [a, b, c] : scene.triangles)
      area_m2 += 0.5 * (scene.vertex_world_m(b) - scene.vertex_world_m(a))
                           .cross(scene.vertex_world_m(c) - scene.vertex_world_m(a))
                           .norm();
    EXPECT_NEAR(area_m2 / wanted_m2, 1, 0.01);
  }
}

TEST(GoalsSuite, ItsSmallestCaseKeepsTheArea) {
  BenchOptions options;
  options.only = "patches-1e4";
  const std::vector<BenchRow> rows = bench_goals(options);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows.front().met(), std::optional(true)) << rows.front().error;
}

}  // namespace
}  // namespace luxrig
