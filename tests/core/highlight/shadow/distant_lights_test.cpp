#include "core/highlight/shadow/distant_lights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/highlight/shadow/relief_contrast.h"
#include "core/highlight/surface/interest_points.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/methods/coverage_lights.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

DirectionHistogram votes_around(const std::vector<std::pair<Vec3, std::uint32_t>>& lobes) {
  DirectionHistogram h{DirectionBins(16), {}, {}};
  h.votes.assign(h.bins.count(), 0);
  h.mean_direction.assign(h.bins.count(), Vec3::Zero());
  for (std::uint32_t b = 0; b < h.bins.count(); ++b) {
    const Vec3 direction = h.bins.direction_of(b);
    for (const auto& [middle, votes] : lobes) {
      const double angle = std::acos(std::clamp(direction.dot(middle), -1.0, 1.0));
      h.votes[b] += static_cast<std::uint32_t>(std::lround(votes * std::exp(-angle * angle / 0.02)));
    }
    if (h.votes[b] > 0) h.mean_direction[b] = direction;
  }
  return h;
}

TEST(DistantLights, LieWhereVotesGather) {
  const std::vector<std::pair<Vec3, std::uint32_t>> lobes = {
      {Vec3(1, 0, 0.5).normalized(), 1000}, {Vec3(-1, 0.3, 0.2).normalized(), 900}, {Vec3(0, -1, 1).normalized(), 700}};
  const auto lights = distant_lights(votes_around(lobes), {3, 0.33});
  ASSERT_TRUE(lights);
  ASSERT_EQ(lights->size(), 3u);
  for (const auto& [middle, votes] : lobes) {
    double nearest = -1;
    for (const DistantLight& light : *lights) nearest = std::max(nearest, light.direction.dot(middle));
    EXPECT_GT(nearest, std::cos(rad_from_deg(3)));
  }
  EXPECT_GE((*lights)[0].share, (*lights)[1].share);
  EXPECT_NEAR((*lights)[0].share + (*lights)[1].share + (*lights)[2].share, 1, 1e-12);
}

TEST(DistantLights, ASingleLightTakesTheFullestBinAndWeakLobesAreCut) {
  const Vec3 strong = Vec3(0.2, 0.9, 0.4).normalized();
  const auto histogram = votes_around({{strong, 1000}, {Vec3(0, 0, -1), 300}});
  const auto one = distant_lights(histogram, {1, 0.33});
  ASSERT_TRUE(one);
  EXPECT_GT((*one)[0].direction.dot(strong), std::cos(rad_from_deg(3)));
  EXPECT_EQ((*one)[0].votes, *std::max_element(histogram.votes.begin(), histogram.votes.end()));
  const auto two = distant_lights(histogram, {2, 0.33});
  for (const DistantLight& light : *two) EXPECT_GT(light.direction.dot(strong), 0.5);
  const auto kept = distant_lights(histogram, {2, 0.2});
  EXPECT_LT(std::min((*kept)[0].direction.dot(strong), (*kept)[1].direction.dot(strong)), 0);
}

TEST(DistantLights, AreFewerWhereFewBinsHaveVotes) {
  auto histogram = votes_around({});
  EXPECT_FALSE(distant_lights(histogram, {}));  // nothing to bring out: an error, not a guess
  histogram.votes[5] = 3;
  histogram.mean_direction[5] = histogram.bins.direction_of(5);
  EXPECT_EQ(distant_lights(histogram, {4, 0.33})->size(), 1u);
  EXPECT_FALSE(distant_lights(histogram, {0, 0.33}));
  EXPECT_FALSE(distant_lights(histogram, {1, 1.5}));
}

struct Chosen {
  TargetSurface surface;
  std::vector<std::uint32_t> interest;
  std::vector<DistantLight> lights;
};

Chosen chosen(const Scene& scene, const TargetRays& target, std::size_t most, int lights) {
  const auto surface = make_target_surface(scene);
  const auto curvature = curvature_of(*surface, {{}, suggested_curvature_radius_m(*surface)});
  InterestOptions options;
  options.max_points = most;
  const auto interest = interest_points(*surface, *curvature, options);
  std::vector<OrientedPoint> points;
  for (const std::uint32_t i : *interest) points.push_back({surface->point_world_m(i), surface->normals[i]});
  const auto edges = find_shadow_edges(target, points, {});
  const auto found = distant_lights(vote_directions(*edges, points, DirectionBins(), 0), {lights, 0.33});
  EXPECT_TRUE(found);
  return {*surface, *interest, *found};
}

std::vector<DistantBeam> beams_of(const std::vector<Vec3>& directions) {
  std::vector<DistantBeam> beams;
  for (const Vec3& d : directions) beams.push_back({d, 1});
  return beams;
}

TEST(DistantLights, RakeAcrossTheRelief) {
  const Scene scene = make_terrain(100, 80);
  const TargetRays target(scene);
  const Chosen c = chosen(scene, target, 300, 1);
  ASSERT_EQ(c.lights.size(), 1u);
  // As in the thesis for its terrain (§6.4.3): at an oblique angle, above the ground.
  const double up = c.lights[0].direction.z();
  EXPECT_GT(up, 0.02);
  EXPECT_LT(up, 0.8);
  const auto contrast = [&](const Vec3& d) {
    return relief_contrast(c.surface, target, c.interest, beams_of({d}), 0, 0).points_with_transition;
  };
  EXPECT_GT(contrast(c.lights[0].direction), 2 * contrast(Vec3::UnitZ()) + 0.1);
}

TEST(DistantLights, BringOutMoreReliefThanCoverageLights) {
  const Scene scene = make_terrain(100, 80);
  const TargetRays target(scene);
  const Chosen c = chosen(scene, target, 300, 2);
  std::vector<Vec3> ours, covering;
  for (const DistantLight& light : c.lights) ours.push_back(light.direction);
  const auto coverage = coverage_lights(c.surface, target, DirectionBins(8), 2, 500, 0);
  for (const CoverageLight& light : coverage) covering.push_back(light.direction);
  ASSERT_FALSE(coverage.empty());
  EXPECT_GT(coverage[0].new_share, 0.9);
  EXPECT_GT(coverage[0].direction.z(), 0.7);
  const auto a = relief_contrast(c.surface, target, c.interest, beams_of(ours), 0, 0);
  const auto b = relief_contrast(c.surface, target, c.interest, beams_of(covering), 0, 0);
  EXPECT_GT(a.points_with_transition, b.points_with_transition);
  EXPECT_GT(a.local_contrast_lx, b.local_contrast_lx);
}

TEST(CoverageLights, LightHalfOfASphereEach) {
  const Scene scene = uv_sphere(1, 30);
  const auto surface = make_target_surface(scene);
  const auto lights = coverage_lights(*surface, TargetRays(scene), DirectionBins(8), 5, 0, 0);
  ASSERT_GE(lights.size(), 2u);
  EXPECT_NEAR(lights[0].new_share, 0.5, 0.03);
  EXPECT_NEAR(lights[1].new_share, 0.5, 0.03);
  EXPECT_LT(lights[0].direction.dot(lights[1].direction), -0.95);
  double share = 0;
  for (const CoverageLight& light : lights) share += light.new_share;
  EXPECT_LE(share, 1 + 1e-9);
  EXPECT_TRUE(coverage_lights(*make_target_surface(Scene{}), TargetRays(Scene{}), DirectionBins(2), 1, 0, 0).empty());
}

TEST(ReliefContrast, OfAStepMatchesItsGeometry) {
  // A level floor, a wall at x = 0 from z = 0 to 1, and an upper floor. Light from -X at 45° leaves x in 0…-1 lit;
  // light from +X shades the lower floor up to x = -1.
  const Scene scene = parametric(3, 1, [](double u, double v) {
    const std::array<Vec3, 4> profile = {Vec3(-4, 0, 0), Vec3(-0.5, 0, 0), Vec3(0, 0, 1), Vec3(4, 0, 1)};
    const Vec3 at = profile[static_cast<std::size_t>(std::lround(3 * u))];
    return Vec3(at.x(), 4 * v - 2, at.z());
  });
  const auto surface = make_target_surface(scene);
  const TargetRays target(scene);
  std::vector<std::uint32_t> foot;  // at x = -0.5
  for (std::uint32_t i = 0; i < surface->points_m.size(); ++i)
    if (surface->points_m[i].x() == -0.5) foot.push_back(i);
  ASSERT_EQ(foot.size(), 2u);
  const Vec3 low(std::cos(0.3), 0, std::sin(0.3));
  const ReliefContrast shaded = relief_contrast(*surface, target, foot, beams_of({low}), 0, 1);
  EXPECT_EQ(shaded.lit_points, 0);
  EXPECT_EQ(shaded.points_with_transition, 1);  // the floor beyond is lit
  EXPECT_NEAR(shaded.local_contrast_lx, std::sin(0.3), 0.3);
  EXPECT_GT(shaded.local_contrast_lx, 0.2);
  const ReliefContrast above = relief_contrast(*surface, target, foot, beams_of({Vec3::UnitZ()}), 0, 1);
  EXPECT_EQ(above.lit_points, 1);
  EXPECT_EQ(above.points_with_transition, 0);
  const ReliefContrast none = relief_contrast(*surface, target, {}, beams_of({low}), 0, 1);
  EXPECT_EQ(none.points_with_transition, 0);
  EXPECT_EQ(relief_contrast(*surface, target, foot, {}, 0, 1).local_contrast_lx, 0);
}

}  // namespace
}  // namespace luxrig
