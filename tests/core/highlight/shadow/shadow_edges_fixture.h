#pragma once
/// Shared by the tests of shadow_edges.

#include <gtest/gtest.h>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/highlight/surface/interest_points.h"

namespace luxrig::shadow_edges_fixture {

struct Bench {
  TargetSurface surface;
  std::vector<OrientedPoint> points;
};

inline Bench with_interest_points(const Scene& scene, std::size_t most) {
  const auto surface = make_target_surface(scene);
  const auto curvature = curvature_of(*surface, {{}, suggested_curvature_radius_m(*surface)});
  InterestOptions options;
  options.max_points = most;
  const auto interest = interest_points(*surface, *curvature, options);
  Bench bench{*surface, {}};
  for (const std::uint32_t i : *interest) bench.points.push_back({surface->point_world_m(i), surface->normals[i]});
  return bench;
}

inline ShadowEdges edges_with(const TargetRays& target, const std::vector<OrientedPoint>& points, int step,
                              int threads = 0) {
  ShadowEdgeOptions options;
  options.step = step;
  options.threads = threads;
  const auto edges = find_shadow_edges(target, points, options);
  EXPECT_TRUE(edges);
  return *edges;
}

}  // namespace luxrig::shadow_edges_fixture
