#include "core/highlight/surface/relief_study.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/random.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

TEST(ReliefStudy, KeepsFeaturesTogetherWhenPointsAreLeftOut) {
  ReliefStudyOptions options;
  options.interest.max_points = 400;
  const auto made = study_relief(make_carved_relief(0.02), options);
  ASSERT_TRUE(made);
  const std::vector<std::uint32_t> interest = made->interest, cluster = made->features.cluster_of_point;
  ReliefStudy study = std::move(*study_relief(make_carved_relief(0.02), options));
  Random random(3);
  std::vector<bool> kept;
  std::vector<std::size_t> was;
  for (std::size_t i = 0; i < interest.size(); ++i) {
    kept.push_back(random.between(0, 1) < 0.3 && cluster[i] != cluster[0]);  // one feature goes altogether
    if (kept.back()) was.push_back(i);
  }
  keep_interest(study, kept);
  ASSERT_EQ(study.interest.size(), was.size());
  ASSERT_EQ(study.points.size(), was.size());
  ASSERT_EQ(study.features.cluster_of_point.size(), was.size());
  for (std::size_t a = 0; a < was.size(); ++a) {
    EXPECT_EQ(study.interest[a], interest[was[a]]);
    EXPECT_EQ(study.points[a].position_world_m, study.surface.point_world_m(study.interest[a]));
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_EQ(study.features.cluster_of_point[a] == study.features.cluster_of_point[b],
                cluster[was[a]] == cluster[was[b]]);
  }
  EXPECT_EQ(std::accumulate(study.features.sizes.begin(), study.features.sizes.end(), std::size_t{0}), was.size());
  for (const auto size : study.features.sizes) EXPECT_GT(size, 0u) << "a feature without points would never be covered";

  keep_interest(study, std::vector<bool>(study.interest.size(), false));
  EXPECT_TRUE(study.interest.empty());
  EXPECT_TRUE(study.features.sizes.empty());
}

}  // namespace
}  // namespace luxrig
