/// domain_votes: the same for any number of threads.
#include <gtest/gtest.h>

#include <cstring>

#include "core/highlight/lights/domain_votes.h"
#include "core/highlight/lights/potential_lights.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/methods/coverage_votes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

TEST(DomainVotes, AreTheSameForAnyNumberOfThreads) {
  const Scene scene = make_terrain(10, 40);
  const TargetRays target(scene);
  const auto surface = make_target_surface(scene);
  std::vector<OrientedPoint> points;
  std::vector<std::uint32_t> features;
  for (std::uint32_t i = 0; i < surface->points_m.size(); i += 20) {
    points.push_back({surface->point_world_m(i), surface->normals[i]});
    features.push_back(i % 17);
  }
  const auto edges = find_shadow_edges(target, points, {});
  const auto domain = nested_box_domain(*surface, {2, 3, 1, 8});
  const RayScene people(ceiling(4, 5));
  const auto with = [&](int threads) {
    DomainVoteOptions options;
    options.threads = threads;
    options.surroundings.occluders = &people;
    auto votes = vote_on_domain(*domain, *edges, points, features, options);
    EXPECT_TRUE(votes);
    PotentialLightOptions beam;
    beam.threads = threads;
    auto lights = potential_lights(*votes, beam);
    EXPECT_TRUE(lights);
    CoverageVoteOptions coverage;
    coverage.threads = threads;
    coverage.max_points = 100;
    auto covering = vote_for_coverage(*domain, *surface, target, coverage);
    EXPECT_TRUE(covering);
    return std::tuple(std::move(*votes), std::move(*lights), std::move(*covering));
  };
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  const auto [votes, lights, covering] = with(1);
  EXPECT_GT(votes.votes.size(), 1000u);
  for (const int threads : {2, 8}) {
    const auto [v, l, c] = with(threads);
    EXPECT_TRUE(same(v.votes, votes.votes));
    EXPECT_TRUE(same(v.begin, votes.begin));
    ASSERT_EQ(v.cells.size(), votes.cells.size());
    for (std::size_t i = 0; i < v.cells.size(); ++i)
      EXPECT_EQ(v.cells[i].centre_world_m, votes.cells[i].centre_world_m);
    EXPECT_TRUE(same(l.votes, lights.votes));
    ASSERT_EQ(l.lights.size(), lights.lights.size());
    for (std::size_t i = 0; i < l.lights.size(); ++i) {
      EXPECT_EQ(l.lights[i].direction, lights.lights[i].direction);
      EXPECT_EQ(l.lights[i].weight, lights.lights[i].weight);
    }
    EXPECT_TRUE(same(c.votes.votes, covering.votes.votes));
  }
}

}  // namespace
}  // namespace luxrig
