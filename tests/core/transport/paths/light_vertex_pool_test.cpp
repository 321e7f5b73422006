/// Light traced from the lamps, by group: its shares and the contents of the pools.

#include "core/transport/paths/light_vertex_pool.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

std::vector<Emitter> row_of_bulbs(std::size_t count, double flux_lm = 100) {
  std::vector<Emitter> bulbs;
  for (std::size_t i = 0; i < count; ++i)
    bulbs.push_back({make_isotropic(flux_lm * static_cast<double>(1 + i % 3)),
                     {Mat3::Identity(), {-0.9 + 1.8 * static_cast<double>(i) / static_cast<double>(count), 0.1, 0.2}}});
  return bulbs;
}

TEST(LampGroups, SharesAddUpAndGroupsKeepTheFluxOfTheirLamps) {
  for (const std::size_t count : {1u, 7u, 64u, 65u, 1000u}) {
    const auto bulbs = row_of_bulbs(count);
    const EmitterSampler lamps(bulbs);
    ASSERT_LE(lamps.groups(), EmitterSampler::kMaxGroups);
    double shares = 0, all_lm = 0;
    std::vector<double> group_lm(lamps.groups(), 0.0);
    for (std::size_t e = 0; e < count; ++e) {
      all_lm += bulbs[e].intensity->flux_lm();
      group_lm[lamps.group_of(e)] += bulbs[e].intensity->flux_lm();
    }
    for (std::size_t g = 0; g < lamps.groups(); ++g) {
      shares += lamps.group_share(g);
      EXPECT_NEAR(lamps.group_share(g), group_lm[g] / all_lm, 1e-12);
      // Whichever lamp of the group is drawn, the sample carries the flux of the whole group.
      for (const double u : {0.0, 0.31, 0.77, 0.999999}) {
        const EmitterRay ray = lamps.emit(g, u, 0.4, 0, 0);
        EXPECT_EQ(lamps.group_of(ray.emitter), g);
        EXPECT_NEAR(ray.flux_lm, group_lm[g], 1e-9 * group_lm[g]);
      }
    }
    EXPECT_NEAR(shares, 1, 1e-12);
  }
}

TEST(LampGroups, WeightsIncludeEveryLampThatLights) {
  // Spots whose beam just reaches or just misses a point. A weight of zero where there is light would cause bias.
  std::vector<Emitter> spots;
  for (int i = 0; i < 200; ++i) {
    const double tilt = 0.01 * i, c = std::cos(tilt), s = std::sin(tilt);
    Mat3 turned;
    turned << 1, 0, 0, 0, c, -s, 0, s, c;
    spots.push_back({make_spot(500, 0.3, 0.6), {turned, {0.01 * i - 1, 0.3, 2}}});
  }
  const EmitterSampler lamps(spots);
  EmitterSampler::Weights weights;
  int lit = 0;
  for (double x = -1; x < 1; x += 0.21) {
    const Vec3 at_m(x, 0.2, 0.1), normal = Vec3(0.3, -0.2, 0.9).normalized();
    lamps.weigh(at_m, normal, weights);
    lamps.light(nullptr, at_m, normal, [&](std::size_t e, double lux) {
      ++lit;
      const double sum = std::accumulate(weights.places.begin(), weights.places.end(), 0.0);
      EXPECT_GT(lamps.choice_density(e, at_m, Vec3::UnitZ(), weights, sum), 0) << "spot " << e << ": " << lux << " lx";
    });
  }
  EXPECT_GT(lit, 100);
}

TEST(LightVertexPool, RefillsContinueTheSequenceInWholeNets) {
  const RayScene rays(make_cube(2, 0.5));
  const auto bulbs = row_of_bulbs(2);
  const EmitterSampler lamps(bulbs, {}, rays.bounds_world_m());
  const auto bsdfs = bsdfs_of(rays);
  const LightTracer lights(rays, lamps, bsdfs);
  EmitterSampler::Weights weights;
  std::uint64_t cost = 0;
  LightVertexPool pool;
  EXPECT_EQ(pool.refill(lights, 5, std::vector<std::uint32_t>{8, 0}, weights), 8u);
  EXPECT_EQ(pool.count(0), 8u);
  EXPECT_TRUE(pool.hits(1).empty());
  EXPECT_EQ(pool.shining(0).size(), 8u) << "all light of a closed room lands";
  // The next 16 start at 16: aligned to a multiple of their count.
  pool.refill(lights, 5, std::vector<std::uint32_t>{16, 4}, weights);
  const SobolSequence first(mixed(5, 0)), second(mixed(5, 1));
  for (std::uint32_t i = 0; i < 16; ++i)
    EXPECT_EQ(pool.hits(0)[i].position_world_m, lights.trace(0, first, 16 + i, weights, cost).position_world_m);
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(pool.hits(1)[i].position_world_m, lights.trace(1, second, i, weights, cost).position_world_m);
}

TEST(LightVertexPlan, StretchesHoldTheExpectedHitsOnAverage) {
  const RayScene rays(make_cube(2, 0.5));
  const auto bulbs = row_of_bulbs(5);
  const EmitterSampler lamps(bulbs, {}, rays.bounds_world_m());
  const auto bsdfs = bsdfs_of(rays);
  EmitterSampler::Weights weights;
  LightVertexPool pool;
  pool.refill(LightTracer(rays, lamps, bsdfs), 5, std::vector<std::uint32_t>(5, 64), weights);
  constexpr std::uint32_t kPaths = 8;
  const std::vector<double> wanted = {0.9, 0.05, 0.03, 0.02, 0};
  const LightVertexPlan plan = LightVertexPlan::of(lamps, wanted, 4 * kPaths, kPaths);
  EXPECT_EQ(plan.at_start[0] * kPaths, 32) << "28.8 hits, as a power of two";
  EXPECT_EQ(plan.at_start[1] * kPaths, 2);
  EXPECT_NEAR(plan.at_start[3] * kPaths, 0.64, 1e-12);
  EXPECT_EQ(plan.at_start[4], 0);
  EXPECT_NEAR(std::accumulate(plan.deeper.begin(), plan.deeper.end(), 0.0), 1, 1e-12);
  EXPECT_GT(plan.deeper[4], 0) << "further vertices may see what the start does not";
  std::vector<double> counts(5, 0.0);
  std::vector<LightVertexRange> stretches;
  constexpr int kDraws = 4000;
  for (int draw = 0; draw < kDraws; ++draw) {
    draw_stretches(plan, pool, kPaths, mixed(1, static_cast<std::uint64_t>(draw)), stretches);
    for (std::size_t g = 0; g < 5; ++g) {
      ASSERT_LE(stretches[g].begin + stretches[g].count, pool.count(g));
      if (stretches[g].count > 0) {
        ASSERT_EQ(stretches[g].begin % stretches[g].count, 0u);
      }
      counts[g] += stretches[g].count;
    }
  }
  for (std::size_t g = 0; g < 5; ++g)
    EXPECT_NEAR(counts[g] / kDraws, plan.at_start[g] * kPaths, 0.05) << "group " << g;  // sd of a mean ≤ 0.008
}

TEST(LightVertexPlan, FollowsTheFluxWithoutWeights) {
  const auto bulbs = row_of_bulbs(3);  // 100, 200, 300 lm
  const EmitterSampler lamps(bulbs);
  const LightVertexPlan plan = LightVertexPlan::of(lamps, std::vector<double>(3, 0.0), 1, 1);
  EXPECT_NEAR(plan.at_start[0] + plan.at_start[1] + plan.at_start[2], 1, 1e-12);
  EXPECT_NEAR(plan.deeper[2], 0.5, 1e-12);
}

}  // namespace
}  // namespace luxrig
