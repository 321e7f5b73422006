/// aim_heads: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/aim/aim_heads.h"
#include "tests/core/highlight/aim/aim_heads_fixture.h"

namespace luxrig {
namespace {

using namespace aim_heads_fixture;

TEST(HeadAims, GivesTheSameBytesForAnyNumberOfThreads) {
  const AimedRelief& relief = aimed_relief();
  std::vector<AimResult> results;
  for (const int threads : {1, 2, 8}) {
    AimOptions options;
    options.threads = threads;
    options.search_points = 150;
    const auto aims = relief.aims(rail_of_heads(3), {}, options);
    ASSERT_TRUE(aims);
    results.push_back(*aims->solve());
  }
  for (const AimResult& other : results) {
    EXPECT_EQ(other.score.objective, results[0].score.objective);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(other.heads[k].setting.level, results[0].heads[k].setting.level);
      EXPECT_EQ(other.heads[k].setting.joints.pan_rad, results[0].heads[k].setting.joints.pan_rad);
    }
  }
}

}  // namespace
}  // namespace luxrig
