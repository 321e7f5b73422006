/// aim_heads by what is seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/highlight/aim/aim_heads_fixture.h"
#include "tests/core/highlight/seen/seen_fixture.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using namespace aim_heads_fixture;

AimWishes wishes_seen(int across_px, int quick_px) {
  const AimedRelief& relief = aimed_relief();
  const auto at = [&](int px) {
    return std::make_shared<const SeenContrast>(
        std::vector{seen_fixture::view_on(relief.room, relief.room, {0.2, -3, 0.3}, px)}, SeenWishes{});
  };
  AimWishes wishes;
  wishes.measure = AimMeasure::seen;
  wishes.seen = at(across_px);
  if (quick_px > 0) wishes.seen_quick = at(quick_px);
  wishes.travel_weight = 0;
  return wishes;
}

TEST(HeadAimsSeen, OneHeadIsAsGoodAsAGridOfAims) {
  const AimedRelief& relief = aimed_relief();
  std::vector<HangingHead> heads = {head_at({-1.2, -0.9, 0.8}, 30)};
  heads[0].reflected_lx = 20;
  const auto aims = relief.aims(heads, wishes_seen(64, 32));
  ASSERT_TRUE(aims) << aims.error().detail;
  const auto found = aims->solve();
  ASSERT_TRUE(found) << found.error().detail;
  ASSERT_TRUE(found->score.seen);
  EXPECT_GT(found->heads[0].setting.level, 0.99);  // nothing limits it
  double best = 0;
  for (double x = -0.7; x <= 0.7; x += 0.1)
    for (double z = -0.5; z <= 0.5; z += 0.1) {
      const HeadSetting setting = looking(heads[0], {x, 0, z}, 1);
      best = std::max(best, aims->score(std::span(&setting, 1)).objective);
    }
  EXPECT_GE(found->score.objective, 0.99 * best);
}

TEST(HeadAimsSeen, FourHeadsBeatRandomLooksAndKeepLimits) {
  const AimedRelief& relief = aimed_relief();
  std::vector<HangingHead> heads = rail_of_heads(4);
  for (HangingHead& head : heads) head.reflected_lx = 10;
  AimWishes wishes = wishes_seen(64, 32);
  const double limit_lx = 150;
  wishes.max_object_lx = limit_lx;
  wishes.limits.push_back({"eye", {{0, -3, 0.3}, Vec3::Zero()}, 40, 0});
  const auto aims = relief.aims(heads, wishes);
  ASSERT_TRUE(aims) << aims.error().detail;
  const auto found = aims->solve();
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->score.within_limits);
  EXPECT_LE(found->score.object_lx, limit_lx * (1 + 1e-6));
  EXPECT_GT(found->score.object_lx, 0.9 * limit_lx);  // as bright as it may be
  EXPECT_LE(found->score.seen->burnt_share + found->score.seen->crushed_share, 0.02 + 1e-9);
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    std::vector<HeadSetting> settings;
    for (const HangingHead& head : heads)
      settings.push_back(
          looking(head, {random.between(-0.6, 0.6), 0, random.between(-0.4, 0.4)}, random.between(0, 1)));
    EXPECT_GE(found->score.objective, aims->score(settings).objective);
  }
}

TEST(HeadAimsSeen, FixedLightFillsShadows) {
  const AimedRelief& relief = aimed_relief();
  const std::vector<HangingHead> heads = {head_at({-1.2, -0.5, 0.8})};
  const HeadSetting setting = looking(heads[0], {0, 0, 0}, 1);
  AimWishes dark = wishes_seen(48, 0), lit = dark;
  lit.seen_fixed_lux.assign(lit.seen->samples().size(), 200);
  const SeenScore in_the_dark = *relief.aims(heads, dark)->score(std::span(&setting, 1)).seen,
                  in_light = *relief.aims(heads, lit)->score(std::span(&setting, 1)).seen;
  EXPECT_LT(in_light.crushed_share, 0.001);
  EXPECT_GT(in_the_dark.crushed_share, 0.01);
  EXPECT_GT(in_light.lit_share, in_the_dark.lit_share);
  EXPECT_NEAR(in_light.mean_lx, in_the_dark.mean_lx + 200, 1e-2);
}

// The second head's power costs more than it could ever bring: at a twentieth of its level, a quarter.
TEST(HeadAimsSeen, ADarkHeadSaysWhatItWouldChange) {
  const AimedRelief& relief = aimed_relief();
  std::vector<HangingHead> heads = {head_at({-1.2, -0.9, 0.8}, 30), head_at({1.2, -0.9, 0.8}, 30)};
  heads[0].watts = 0;
  heads[1].watts = 100;
  AimWishes wishes = wishes_seen(64, 32);
  wishes.energy_weight = 5;
  const auto aims = relief.aims(heads, wishes);
  ASSERT_TRUE(aims) << aims.error().detail;
  const auto found = aims->solve();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->heads[1].setting.level, 0);
  EXPECT_TRUE(std::isnan(found->gain_if_lit[0]));
  EXPECT_LT(found->gain_if_lit[1], 0);
  EXPECT_GT(found->gain_if_lit[1], -0.5);
  // Without the only light nothing is seen.
  EXPECT_EQ(found->without[0].seen->lit_share, 0);
  EXPECT_EQ(found->without[1].objective, found->score.objective);
}

TEST(HeadAimsSeen, ARolesLuxIsReachedAndNotExceeded) {
  const AimedRelief& relief = aimed_relief();
  const std::vector<HangingHead> heads = {head_at({-1.2, -0.9, 0.8}, 30), head_at({1.2, -0.9, 0.8}, 30)};
  AimWishes wishes = wishes_seen(64, 0);
  wishes.seen_fixed_lux.assign(wishes.seen->samples().size(), 15);
  for (std::size_t s = 0; s < wishes.seen->samples().size(); ++s)
    wishes.role.wanted.push_back(wishes.seen->of_object(s) ? 1 : 0);
  const auto count = static_cast<float>(std::count(wishes.role.wanted.begin(), wishes.role.wanted.end(), 1.0f));
  for (float& one : wishes.role.wanted) one /= count;
  for (const double wanted_lx : {5.0, 20.0}) {
    wishes.role.wanted_lx = wanted_lx;
    const auto aims = relief.aims(heads, wishes);
    ASSERT_TRUE(aims) << aims.error().detail;
    const auto found = aims->solve();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->score.role->wanted_lx, wanted_lx, 0.01 * wanted_lx);
  }
}

TEST(HeadAimsSeen, RefusesWhatDoesNotFit) {
  const AimedRelief& relief = aimed_relief();
  const std::vector<HangingHead> heads = {head_at({-1.2, -0.5, 0.8})};
  AimWishes without;
  without.measure = AimMeasure::seen;
  EXPECT_FALSE(relief.aims(heads, without));
  AimWishes unused = wishes_seen(32, 0);
  unused.measure = AimMeasure::lux;
  EXPECT_FALSE(relief.aims(heads, unused));
  AimWishes wrong = wishes_seen(32, 0);
  wrong.seen_fixed_lux = {1, 2, 3};
  EXPECT_FALSE(relief.aims(heads, wrong));
  wrong.seen_fixed_lux.assign(wrong.seen->samples().size(), -1);
  EXPECT_FALSE(relief.aims(heads, wrong));
  std::vector<HangingHead> odd = heads;
  odd[0].reflected_lx = -1;
  EXPECT_FALSE(relief.aims(odd, wishes_seen(32, 0)));
}

}  // namespace
}  // namespace luxrig
