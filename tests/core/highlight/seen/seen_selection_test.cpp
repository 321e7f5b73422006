#include "core/highlight/seen/seen_selection.h"

#include <gtest/gtest.h>

#include <stop_token>

#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

/// Ridges seen from above, and lamps around them at several heights.
struct LitRidges {
  RayScene object{ridges(5, 0.015)};
  SeenContrast seen{{view_on(object, object, {0, 0, 3}, 48)}, {}};
  Intensity lamp = make_cosine_power(1000, 3);

  static std::vector<SeenCandidate> ring(int count) {
    std::vector<SeenCandidate> lights;
    for (int k = 0; k < count; ++k) {
      const double around = 2 * kPi * k / count, up = rad_from_deg(20 + 60 * (k % 3) / 2.0);
      const Vec3 at = 2 * Vec3(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
      lights.push_back({at, -at.normalized()});
    }
    return lights;
  }
  [[nodiscard]] SeenSelection selection(std::vector<SeenCandidate> lights, const SeenSelectionOptions& how = {}) const {
    return SeenSelection(seen, object, std::move(lights), *lamp, {}, how);
  }
};

TEST(SeenSelection, OneLightIsTheBestOfAll) {
  const LitRidges of;
  const SeenSelection selection = of.selection(LitRidges::ring(24));
  const auto found = selection.up_to(1);
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found[0].candidates.size(), 1u);
  const double one = 1;
  for (std::size_t c = 0; c < 24; ++c)
    EXPECT_GE(found[0].score.objective, selection.score(std::span(&c, 1), std::span(&one, 1)).objective);
}

TEST(SeenSelection, TwoLightsAreNearTheBestPair) {
  const LitRidges of;
  const SeenSelection selection = of.selection(LitRidges::ring(12));
  const auto found = selection.up_to(2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GE(found[1].score.objective, found[0].score.objective - 0.02);
  double best = 0;
  for (std::size_t a = 0; a < 12; ++a)
    for (std::size_t b = 0; b < 12; ++b)
      for (const double level : {1.0, 0.6, 0.35, 0.2, 0.1}) {
        if (a == b) continue;
        const std::size_t pair[] = {a, b};
        const double levels[] = {1, level};
        best = std::max(best, selection.score(pair, levels).objective);
      }
  EXPECT_GE(found[1].score.objective, 0.97 * best);
}

TEST(SeenSelection, NeverTwoAtOnePlaceAndNoMoreThanThereAre) {
  const LitRidges of;
  std::vector<SeenCandidate> lights = LitRidges::ring(3);
  lights.push_back(lights[0]);  // the same place with another aim
  lights.back().direction = (lights.back().direction + Vec3(0.1, 0, 0)).normalized();
  const auto found = of.selection(lights).up_to(6);
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GT(
          (lights[found[2].candidates[a]].position_world_m - lights[found[2].candidates[b]].position_world_m).norm(),
          0.1);
  EXPECT_TRUE(of.selection({}).up_to(2).empty());
}

TEST(SeenSelection, StopsWhenAsked) {
  const LitRidges of;
  std::stop_source stop;
  stop.request_stop();
  SeenSelectionOptions how;
  how.watch.stop = stop.get_token();
  EXPECT_TRUE(of.selection(LitRidges::ring(6), how).up_to(3).empty());
}

}  // namespace
}  // namespace luxrig
