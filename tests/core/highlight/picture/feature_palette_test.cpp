#include "core/highlight/picture/feature_palette.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/random.h"

namespace luxrig {
namespace {

TEST(FeaturePalette, AChainNeedsOnlyTwoColours) {
  std::vector<OrientedPoint> points;
  FeatureClusters features;
  for (std::uint32_t cluster = 0; cluster < 9; ++cluster)
    for (std::uint32_t i = 0; i < 9 - cluster; ++i) {  // largest first, along the chain
      points.push_back({Vec3(cluster, 0.1 * i, 0), Vec3::UnitZ()});
      features.cluster_of_point.push_back(cluster);
    }
  for (std::uint32_t cluster = 0; cluster < 9; ++cluster) features.sizes.push_back(9 - cluster);
  const auto colours = feature_colours(points, features, 1.0, 2);
  for (std::uint32_t cluster = 0; cluster < 9; ++cluster) EXPECT_EQ(colours[cluster], cluster % 2);
  // Where no cluster is near another, all have the first colour.
  for (const std::uint32_t colour : feature_colours(points, features, 0.5, 2)) EXPECT_EQ(colour, 0u);
}

TEST(FeaturePalette, NeighboursDifferWhenThereAreEnoughColours) {
  Random random(5);
  std::vector<OrientedPoint> points;
  FeatureClusters features;
  features.sizes.assign(60, 0);
  for (int i = 0; i < 600; ++i) {
    const auto cluster = static_cast<std::uint32_t>(random.below(60));
    Random place(1000 + cluster);
    points.push_back({Vec3(place.in_cube() + 0.05 * random.in_cube()), Vec3::UnitZ()});
    features.cluster_of_point.push_back(cluster);
    ++features.sizes[cluster];
  }
  constexpr double kNear_m = 0.3;
  const auto colours = feature_colours(points, features, kNear_m, 12);
  std::size_t neighbours = 0;
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const std::uint32_t of_a = features.cluster_of_point[a], of_b = features.cluster_of_point[b];
      if (of_a == of_b || (points[a].position_world_m - points[b].position_world_m).norm() > kNear_m) continue;
      ++neighbours;
      EXPECT_NE(colours[of_a], colours[of_b]);
    }
  EXPECT_GT(neighbours, 100u);
  EXPECT_GT(std::set(colours.begin(), colours.end()).size(), 2u);
}

TEST(FeaturePalette, TakesTheRarestNeighbouringColourWhenThereAreTooFew) {
  // All near each other: five clusters, two colours, which alternate.
  std::vector<OrientedPoint> points;
  FeatureClusters features;
  for (std::uint32_t cluster = 0; cluster < 5; ++cluster) {
    points.push_back({Vec3(0.1 * cluster, 0, 0), Vec3::UnitZ()});
    features.cluster_of_point.push_back(cluster);
    features.sizes.push_back(1);
  }
  EXPECT_EQ(feature_colours(points, features, 1, 2), (std::vector<std::uint32_t>{0, 1, 0, 1, 0}));
}

}  // namespace
}  // namespace luxrig
