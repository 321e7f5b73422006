/// aim_heads: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/highlight/aim/aim_heads.h"
#include "tests/core/highlight/aim/aim_heads_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using namespace aim_heads_fixture;

TEST(HeadAims, OneHeadIsAsGoodAsAFineGridOfAimsAndLevels) {
  const AimedRelief& relief = aimed_relief();
  const std::vector<HangingHead> heads = {head_at({-1.2, -0.5, 0.8}, 200)};
  AimWishes wishes;
  wishes.travel_weight = 0;
  AimOptions options;
  options.search_points = 0;
  const auto aims = relief.aims(heads, wishes, options);
  ASSERT_TRUE(aims);
  const auto found = aims->solve();
  ASSERT_TRUE(found) << found.error().detail;
  double best = 0;
  for (double x = -0.7; x <= 0.7; x += 0.05)
    for (double z = -0.5; z <= 0.5; z += 0.05)
      for (const double level : {0.3, 0.6, 1.0}) {
        const HeadSetting setting = looking(heads[0], {x, 0, z}, level);
        best = std::max(best, aims->score(std::span(&setting, 1)).objective);
      }
  EXPECT_GE(found->score.objective, 0.99 * best);
  EXPECT_GT(found->heads[0].setting.level, 0.99);  // nothing limits it
}

TEST(HeadAims, EightHeadsBeatTwoHundredRandomLooks) {
  const AimedRelief& relief = aimed_relief();
  const std::vector<HangingHead> heads = rail_of_heads(8);
  const auto aims = relief.aims(heads);
  ASSERT_TRUE(aims);
  const auto found = aims->solve();
  ASSERT_TRUE(found);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    std::vector<HeadSetting> settings;
    for (const HangingHead& head : heads)
      settings.push_back(
          looking(head, {random.between(-0.6, 0.6), 0, random.between(-0.4, 0.4)}, random.between(0, 1)));
    EXPECT_GE(found->score.objective, aims->score(settings).objective);
  }
}

}  // namespace
}  // namespace luxrig
