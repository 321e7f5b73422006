/// shadow_edges: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/shadow/shadow_edges.h"
#include "tests/core/highlight/shadow/shadow_edges_fixture.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace shadow_edges_fixture;

TEST(ShadowEdges, AreTheSameForAnyNumberOfThreads) {
  const Scene scene = make_carved_relief(0.02);
  const Bench bench = with_interest_points(scene, 50);
  ASSERT_GT(bench.points.size(), 20u);
  const TargetRays target(scene);
  const ShadowEdges one = edges_with(target, bench.points, 4, 1);
  for (const int threads : {2, 5}) {
    const ShadowEdges many = edges_with(target, bench.points, 4, threads);
    EXPECT_EQ(one.edges, many.edges);
    EXPECT_EQ(one.begin, many.begin);
    EXPECT_EQ(one.rays, many.rays);
  }
}

}  // namespace
}  // namespace luxrig
