#include "core/highlight/surface/feature_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/random.h"

namespace luxrig {
namespace {

FeatureClusters clustered(const std::vector<OrientedPoint>& points, double link_m) {
  auto clusters = cluster_features(points, {link_m, rad_from_deg(36)});
  EXPECT_TRUE(clusters);
  return *clusters;
}

/// Single linkage as the header defines it, but over all pairs within reach, O(n² log n): the reference.
std::vector<std::uint32_t> by_all_pairs(const std::vector<OrientedPoint>& points, double link_m, double angle_rad) {
  struct Pair {
    double distance_m;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double d = (points[i].position_world_m - points[j].position_world_m).norm();
      if (d <= link_m) pairs.push_back({d, i, j});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    return std::tie(x.distance_m, x.a, x.b) < std::tie(y.distance_m, y.a, y.b);
  });
  std::vector<std::uint32_t> cluster(points.size());
  std::vector<Vec3> sums;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    cluster[i] = i;
    sums.push_back(points[i].normal);
  }
  for (const Pair& pair : pairs) {
    const std::uint32_t a = cluster[pair.a], b = cluster[pair.b];
    if (a == b || std::acos(std::clamp(sums[a].normalized().dot(sums[b].normalized()), -1.0, 1.0)) > angle_rad)
      continue;
    sums[a] += sums[b];
    for (std::uint32_t& c : cluster)
      if (c == b) c = a;
  }
  return cluster;
}

TEST(FeatureClusters, MatchAllPairsWhereReachIsShort) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<OrientedPoint> points;
    for (int i = 0; i < 300; ++i) {
      const Vec3 at = random.in_cube();
      points.push_back({Vec3(at.x(), at.y(), 0.1 * at.z()), (Vec3(0, 0, 1) + 0.7 * random.direction()).normalized()});
    }
    // 0.16 on a plate of side 2: six neighbours on average, at most twelve.
    const auto mine = clustered(points, 0.16).cluster_of_point;
    const auto reference = by_all_pairs(points, 0.16, rad_from_deg(36));
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_EQ(mine[i] == mine[j], reference[i] == reference[j]) << "seed " << seed << ", " << i << ", " << j;
  }
}

TEST(FeatureClusters, SplitWhereASurfaceTurnsByMoreThanTheAngle) {
  // Two strips that meet at a right angle, and one level with the first but 1 m away.
  std::vector<OrientedPoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({{0.01 * i, 0, 0}, {0, 0, 1}});
  for (int i = 0; i < 50; ++i) points.push_back({{0.5, 0, 0.01 * i}, {-1, 0, 0}});
  for (int i = 0; i < 50; ++i) points.push_back({{0.01 * i, 1, 0}, {0, 0, 1}});
  const FeatureClusters clusters = clustered(points, 0.02);
  ASSERT_EQ(clusters.sizes, (std::vector<std::uint32_t>{50, 50, 50}));
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(clusters.cluster_of_point[i], i / 50);
}

TEST(FeatureClusters, DoNotCreepRoundABend) {
  // Each point is within 36° of its neighbour, but the cluster's mean counts: a full circle is not one feature.
  std::vector<OrientedPoint> points;
  for (int i = 0; i < 360; ++i) {
    const Vec3 out(std::cos(rad_from_deg(i)), std::sin(rad_from_deg(i)), 0);
    points.push_back({out, out});
  }
  EXPECT_GE(clustered(points, 0.05).sizes.size(), 3u);
}

TEST(FeatureClusters, HandleEmptyInputAndRefuseInvalidInput) {
  EXPECT_TRUE(clustered({}, 1).sizes.empty());
  EXPECT_EQ(clustered({{Vec3::Zero(), Vec3::UnitZ()}}, 1).sizes, std::vector<std::uint32_t>{1});
  // A hundred points at one place, and some without a normal, which join no cluster.
  std::vector<OrientedPoint> same(100, {Vec3(1, 2, 3), Vec3::UnitX()});
  EXPECT_LE(clustered(same, 0.1).sizes.size(), 100u);
  same.assign(5, {Vec3::Zero(), Vec3::Zero()});
  EXPECT_EQ(clustered(same, 0.1).sizes.size(), 5u);
  EXPECT_FALSE(cluster_features(same, {0, 1}));
  EXPECT_FALSE(cluster_features(same, {std::numeric_limits<double>::quiet_NaN(), 1}));
  same[0].position_world_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(cluster_features(same, {1, 1}));
}

}  // namespace
}  // namespace luxrig
