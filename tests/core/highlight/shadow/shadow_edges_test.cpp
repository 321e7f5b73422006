#include "core/highlight/shadow/shadow_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/highlight/shadow/direction_bins.h"
#include "tests/core/highlight/shadow/shadow_edges_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace shadow_edges_fixture;

/// A wall of height 1 round the origin, at distance 1: its horizon is at 45° in all directions.
Scene ring_wall() {
  return parametric(720, 1, [](double u, double v) {
    const double phi = 2 * kPi * (u - std::floor(u));
    return Vec3(std::cos(phi), std::sin(phi), 1.5 * v - 0.5);
  });
}

TEST(ShadowEdges, LieAtTheHorizonOfARingWall) {
  const TargetRays target(ring_wall());
  const std::vector<OrientedPoint> points = {{Vec3::Zero(), Vec3::UnitZ()}};
  for (const int step : {1, 2, 4, 8}) {
    const ShadowEdges edges = edges_with(target, points, step);
    ASSERT_EQ(edges.edges.size(), 360u) << step;
    for (const ShadowEdge& edge : edges.edges) EXPECT_EQ(edge.elevation, 45) << edge.azimuth;  // 45.5°, above the rim
    for (std::uint16_t i = 0; i < 360; ++i) EXPECT_EQ(edges.edges[i].azimuth, i);
  }
}

TEST(ShadowEdges, LieBelowAndAboveAPlate) {
  // A square plate of 0.4 × 0.4 at x = 1, facing the point: edges on both sides of it, only within its azimuths.
  Scene plate;
  plate.vertices_m = {{1, -0.2f, 0.4f}, {1, 0.2f, 0.4f}, {1, 0.2f, 0.8f}, {1, -0.2f, 0.8f}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TargetRays target(with_one_material(plate));
  const std::vector<OrientedPoint> points = {{Vec3::Zero(), Vec3::UnitZ()}};
  std::vector<ShadowEdge> truth;
  const ScanFrame frame(Vec3::UnitZ());
  for (int i = 0; i < kScanAzimuths; ++i) {
    const auto inside = [&](int j) {
      const Vec3f d = frame.direction(i, j);
      return d.x() > 0 && std::abs(d.y() / d.x()) < 0.2f && d.z() / d.x() > 0.4f && d.z() / d.x() < 0.8f;
    };
    for (int j = 0; j + 1 < kScanElevations; ++j)
      if (inside(j) != inside(j + 1))
        truth.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(inside(j) ? j + 1 : j)});
  }
  ASSERT_GT(truth.size(), 40u);
  EXPECT_EQ(edges_with(target, points, 1).edges, truth);
  EXPECT_EQ(edges_with(target, points, 4).edges, truth);
  EXPECT_LT(edges_with(target, points, 4).rays, 2500u);
}

TEST(ShadowEdges, AnOpeningOfOneStepGivesTwoEdges) {
  HorizonMask blocked;
  for (int j = 0; j < kScanElevations; ++j) blocked.set(7, j, j < 10 || (j > 10 && j < 20));
  std::vector<ShadowEdge> edges;
  append_edges(blocked, edges);
  EXPECT_EQ(edges, (std::vector<ShadowEdge>{{7, 10}, {7, 10}, {7, 20}}));
}

/// Edges are ordered by azimuth, then elevation.
int in_order(const ShadowEdge& edge) { return edge.azimuth * kScanElevations + edge.elevation; }

TEST(ShadowEdges, SearchMatchesTracingEveryRay) {
  for (const Scene& scene : {make_carved_relief(0.015), make_terrain(100, 60), torus(1, 0.7, 60, 40)}) {
    const Bench bench = with_interest_points(scene, 60);
    ASSERT_GT(bench.points.size(), 20u);
    const TargetRays target(scene);
    const ShadowEdges every = edges_with(target, bench.points, 1), found = edges_with(target, bench.points, 4);
    ASSERT_GT(every.edges.size(), 1000u);
    EXPECT_EQ(every.rays, 32400u * bench.points.size());
    EXPECT_LT(found.rays, every.rays * 15 / 100);
    const DirectionBins bins;
    EXPECT_LT(
        histogram_error(vote_directions(found, bench.points, bins, 0), vote_directions(every, bench.points, bins, 0)),
        0.01);
    // No false edges are found.
    for (std::size_t i = 0; i < bench.points.size(); ++i)
      ASSERT_TRUE(std::ranges::includes(every.of(i), found.of(i), {}, in_order, in_order)) << i;
  }
}

TEST(ShadowEdges, OneDetectedPinholeLeadsToTheOthers) {
  // A screen of 200 × 200 above the point with a hole in every tenth place, smaller than the gaps between first rays.
  Scene screen;
  const int split = 200;
  for (int i = 0; i <= split; ++i)
    for (int j = 0; j <= split; ++j)
      screen.vertices_m.push_back(Vec3(4.0 * i / split - 2, 4.0 * j / split - 2, 1).cast<float>());
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (split + 1) + j); };
  for (int i = 0; i < split; ++i) {
    for (int j = 0; j < split; ++j) {
      if (i % 10 == 5 && j % 10 == 5) continue;
      screen.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      screen.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const TargetRays target(with_one_material(screen));
  const std::vector<OrientedPoint> points = {{Vec3::Zero(), Vec3::UnitZ()}};
  const ShadowEdges every = edges_with(target, points, 1), found = edges_with(target, points, 4);
  EXPECT_GT(every.edges.size(), 500u);
  EXPECT_EQ(found.edges, every.edges);
  EXPECT_GT(found.rays, every.rays);  // the cost of it
}

TEST(ShadowEdges, AreTheSameAtAnySizeAndPlace) {
  const Scene scene = torus(1, 0.7, 60, 40);
  const Bench bench = with_interest_points(scene, 30);
  ASSERT_GT(bench.points.size(), 15u);
  const ShadowEdges one = edges_with(TargetRays(scene), bench.points, 4);
  for (const double scale : {0.0005, 500.0}) {
    Scene other = transformed(scene, scale, Mat3::Identity(), Vec3::Zero());
    other.origin_world_m = Vec3(4e5, 5e6, 100);
    std::vector<OrientedPoint> points = bench.points;
    for (OrientedPoint& p : points) p.position_world_m = scale * p.position_world_m + other.origin_world_m;
    const ShadowEdges two = edges_with(TargetRays(other), points, 4);
    // A millimetre at 5 000 km is off by a nanometre: a few rays that graze an edge fall on the other side.
    EXPECT_NEAR(static_cast<double>(two.edges.size()), static_cast<double>(one.edges.size()),
                0.01 * static_cast<double>(one.edges.size()));
  }
}

TEST(ShadowEdges, AreAbsentWithoutRelief) {
  const std::vector<OrientedPoint> point = {{Vec3(0, 0, 1), Vec3::UnitZ()}};
  EXPECT_TRUE(edges_with(TargetRays(uv_sphere(1, 40)), point, 4).edges.empty());
  EXPECT_TRUE(edges_with(TargetRays(Scene{}), point, 4).edges.empty());
  Scene points_only;
  points_only.vertices_m = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(edges_with(TargetRays(with_one_material(points_only)), point, 1).edges.empty());
  // Inside a closed box everything is blocked.
  Scene inside = uv_sphere(2, 20);
  EXPECT_TRUE(edges_with(TargetRays(inside), point, 4).edges.empty());
  // No normal, no hemisphere.
  EXPECT_TRUE(edges_with(TargetRays(ring_wall()), {{Vec3::Zero(), Vec3::Zero()}}, 4).edges.empty());
  EXPECT_TRUE(edges_with(TargetRays(ring_wall()), {}, 4).edges.empty());
}

TEST(ShadowEdges, RefuseInvalidOptions) {
  const TargetRays target(ring_wall());
  ShadowEdgeOptions options;
  options.step = 0;
  EXPECT_FALSE(find_shadow_edges(target, {}, options));
  options.step = 9;
  EXPECT_FALSE(find_shadow_edges(target, {}, options));
  options = {};
  options.lift_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(find_shadow_edges(target, {}, options));
  options = {};
  std::stop_source stop;
  stop.request_stop();
  options.watch.stop = stop.get_token();
  EXPECT_FALSE(find_shadow_edges(target, {}, options));
}

TEST(ShadowEdges, ReachOnlyWhereSurroundingsAllow) {
  const TargetRays target(ring_wall());
  const std::vector<OrientedPoint> points = {{Vec3::Zero(), Vec3::UnitZ()}};
  const ShadowEdges edges = edges_with(target, points, 4);
  // A wall at x = 5, very wide and high: it stops all edges towards it, half of them.
  Scene wall;
  wall.vertices_m = {{5, -1e4f, -1e4f}, {5, 1e4f, -1e4f}, {5, 1e4f, 1e4f}, {5, -1e4f, 1e4f}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const RayScene surroundings(with_one_material(wall));
  const double infinite = std::numeric_limits<double>::infinity();
  const ShadowEdges left = reachable_edges(edges, points, surroundings, infinite, 0);
  EXPECT_NEAR(static_cast<double>(left.edges.size()), 180, 2);
  const ScanFrame frame(points[0].normal);
  for (const ShadowEdge& edge : left.edges) EXPECT_LT(frame.direction(edge.azimuth, edge.elevation).x(), 1e-3f);
  // The wall does not affect lights nearer than it.
  EXPECT_EQ(reachable_edges(edges, points, surroundings, 4, 0).edges, edges.edges);
  EXPECT_EQ(reachable_edges(edges, points, RayScene(Scene{}), infinite, 0).edges, edges.edges);
}

TEST(DirectionBins, HaveEqualAreaAndContainTheirCentres) {
  for (const int side : {1, 2, 5, 16}) {
    const DirectionBins bins(side);
    for (std::uint32_t b = 0; b < bins.count(); ++b) {
      EXPECT_NEAR(bins.direction_of(b).norm(), 1, 1e-12);
      ASSERT_EQ(bins.bin_of(bins.direction_of(b)), b) << "side " << side;
    }
  }
  const DirectionBins bins(4);
  std::vector<int> count(bins.count(), 0);
  Random random(1);
  const int all = 400000;
  double farthest = 1;
  for (int i = 0; i < all; ++i) {
    const Vec3 direction = random.direction();
    const std::uint32_t bin = bins.bin_of(direction);
    ++count[bin];
    farthest = std::min(farthest, direction.dot(bins.direction_of(bin)));
  }
  const double mean = static_cast<double>(all) / bins.count();  // ± 4.6 standard deviations
  for (const int c : count) EXPECT_NEAR(c, mean, 4.6 * std::sqrt(mean));
  EXPECT_GT(farthest, std::cos(rad_from_deg(14.7)));  // cells of 14.7° across: no ray is so far from its middle
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(-1, -1e-300, 0)})
    EXPECT_LT(bins.bin_of(axis), bins.count());
}

}  // namespace
}  // namespace luxrig
