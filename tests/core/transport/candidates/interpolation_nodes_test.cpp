#include "core/transport/candidates/reflected/interpolation_nodes.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig {
namespace {

std::vector<Vec3> random_places(const Vec3& low_m, const Vec3& high_m, std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> places_m;
  for (std::size_t i = 0; i < count; ++i)
    places_m.push_back(low_m + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(high_m - low_m));
  return places_m;
}

TEST(InterpolationNodes, ReproduceLinearFunctionsOfPlace) {
  const Scene scene = two_rooms(0.5, true);
  const RayScene rays(scene);
  const auto linear = [](const Vec3& at_m) { return 5 + at_m.dot(Vec3(0.3, -0.7, 0.2)); };
  const auto places_m = random_places({0.1, 0.1, 0.9}, {3.9, 2.9, 2.4}, 4000);
  const std::vector<std::uint8_t> usable(places_m.size(), 1);
  const InterpolationNodes nodes(places_m, usable, 0.4);
  EXPECT_LT(nodes.size() * 6, places_m.size());
  std::vector<WeightedRow> shares;
  std::uint64_t cast = 0;
  std::size_t interpolated = 0;
  for (std::uint32_t p = 0; p < places_m.size(); p += 7) {
    nodes.shares(rays, places_m[p], Vec3::Zero(), shares, cast);
    if (shares.empty()) continue;
    ++interpolated;
    double value = 0, sum = 0;
    for (const WeightedRow& share : shares) {
      value += static_cast<double>(share.weight) * linear(places_m[nodes.position(share.row)]);
      sum += static_cast<double>(share.weight);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    // The ridge flattens slopes: it costs about a hundredth of the change over the spread of the nodes.
    EXPECT_NEAR(value, linear(places_m[p]), 0.03);
  }
  EXPECT_GT(interpolated, places_m.size() / 7 * 8 / 10);  // all but the corners
}

TEST(InterpolationNodes, ReproduceSlopesOfLinearFunctions) {
  const Scene scene = two_rooms(0.5, true);
  const RayScene rays(scene);
  const Vec3 slope(0.3, -0.7, 0.2);
  const auto places_m = random_places({0.1, 0.1, 0.9}, {3.9, 2.9, 2.4}, 4000);
  const std::vector<std::uint8_t> usable(places_m.size(), 1);
  const InterpolationNodes nodes(places_m, usable, 0.4);
  std::vector<WeightedRow> shares;
  std::vector<Vec3> slopes_per_m;
  std::uint64_t cast = 0;
  std::size_t near = 0, all = 0;
  for (std::uint32_t p = 0; p < places_m.size(); p += 7) {
    nodes.shares(rays, places_m[p], Vec3::Zero(), shares, cast, ~0u, &slopes_per_m);
    if (shares.empty()) continue;
    ASSERT_EQ(slopes_per_m.size(), shares.size());
    Vec3 found = Vec3::Zero();
    for (std::size_t i = 0; i < shares.size(); ++i)
      found += slopes_per_m[i] * places_m[nodes.position(shares[i].row)].dot(slope);
    ++all;
    if ((found - slope).norm() < 0.1 * slope.norm()) ++near;  // the ridge takes a few per cent
  }
  EXPECT_GE(near, all * 9 / 10);
}

TEST(InterpolationNodes, DoNotInterpolateThroughWallsOrFromAnExcludedNode) {
  const Scene scene = two_rooms(0.5, false);
  const RayScene rays(scene);
  const auto places_m = random_places({0.05, 0.05, 0.9}, {8.1, 2.95, 2.45}, 3000);
  std::vector<std::uint8_t> usable(places_m.size());
  for (std::size_t p = 0; p < places_m.size(); ++p) usable[p] = places_m[p].x() < 3.99 || places_m[p].x() > 4.16;
  const InterpolationNodes nodes(places_m, usable, 0.5);
  std::vector<WeightedRow> shares;
  std::uint64_t cast = 0;
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const Vec3& at_m = places_m[nodes.position(n)];
    EXPECT_TRUE(usable[nodes.position(n)]);
    nodes.shares(rays, at_m, Vec3::Zero(), shares, cast, n);
    for (const WeightedRow& share : shares) {
      EXPECT_NE(share.row, n);
      EXPECT_EQ(places_m[nodes.position(share.row)].x() < 4, at_m.x() < 4);
    }
  }
}

TEST(InterpolationNodes, AreAsFineAsAllowedAndTolerateOddInput) {
  const auto places_m = random_places({-1, -1, 0}, {1, 1, 0}, 900);  // a plane
  const std::vector<std::uint8_t> usable(places_m.size(), 1), none(places_m.size(), 0);
  const double step_m = InterpolationNodes::step_for(places_m, usable, 100);
  ASSERT_GT(step_m, 0);
  EXPECT_LE(InterpolationNodes(places_m, usable, step_m).size(), 100u);
  EXPECT_GT(InterpolationNodes(places_m, usable, 0.8 * step_m).size(), 100u);
  EXPECT_EQ(InterpolationNodes::step_for(places_m, none, 100), 0);
  EXPECT_EQ(InterpolationNodes::step_for(places_m, usable, 0), 0);
  EXPECT_EQ(InterpolationNodes::step_for({}, {}, 100), 0);
  const std::vector<Vec3> same_m(50, Vec3(3, 2, 1));
  EXPECT_EQ(InterpolationNodes::step_for(same_m, std::vector<std::uint8_t>(50, 1), 10), 0);
  EXPECT_EQ(InterpolationNodes(places_m, none, 1).size(), 0u);
  const Scene scene = two_rooms(0.5, true);
  const RayScene rays(scene);
  std::vector<WeightedRow> shares = {{1, 1}};
  std::uint64_t cast = 0;
  InterpolationNodes().shares(rays, {1, 1, 1}, Vec3::Zero(), shares, cast);
  EXPECT_TRUE(shares.empty());
  for (const double scale : {1e-3, 1.0, 1e4}) {
    std::vector<Vec3> scaled_m;
    for (const Vec3& at : places_m) scaled_m.push_back(scale * at);
    EXPECT_NEAR(InterpolationNodes::step_for(scaled_m, usable, 100), scale * step_m, 1e-9 * scale);
  }
}

// Regression: at the full requested density no node had a neighbour within reach, so every place stayed dark.
TEST(InterpolationNodes, LeaveNeighboursInReachAtTheFinestStep) {
  std::vector<Vec3> places_m;
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 9; ++y) places_m.emplace_back(0.2 * x, 0.2 * y, 1.5);
  const std::vector<std::uint8_t> usable(places_m.size(), 1);
  const double step_m = InterpolationNodes::step_for(places_m, usable, 4000);
  EXPECT_GT(step_m, 0.8 * 0.2 * 0.99);
  const InterpolationNodes nodes(places_m, usable, step_m);
  EXPECT_EQ(nodes.size(), places_m.size());
  const Scene scene = two_rooms(0.5, true);
  const RayScene rays(scene);
  std::vector<WeightedRow> shares;
  std::uint64_t cast = 0;
  nodes.shares(rays, {1.1, 0.7, 1.5}, Vec3::Zero(), shares, cast);
  EXPECT_GE(shares.size(), 4u);
}

}  // namespace
}  // namespace luxrig
