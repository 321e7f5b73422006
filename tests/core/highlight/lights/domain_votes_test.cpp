#include "core/highlight/lights/domain_votes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/highlight/lights/potential_lights.h"
#include "tests/core/highlight/lights/even_layers.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/methods/coverage_votes.h"

namespace luxrig {
namespace {

LightDomain domain_over(const Scene& scene, const Vec3& centre, const LightDomainOptions& options = {}) {
  auto domain = mesh_light_domain(scene, {}, centre, options);
  EXPECT_TRUE(domain) << domain.error().detail;
  return std::move(*domain);
}

/// Points at random places in a box, with random edges instead of found ones: the votes do not depend on their origin.
struct DrawnEdges {
  std::vector<OrientedPoint> points;
  ShadowEdges edges;
  std::vector<std::uint32_t> features;

  DrawnEdges(std::size_t count, std::size_t per_point, unsigned seed, const Vec3& shift = Vec3::Zero()) {
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back({shift + 0.5 * random.in_cube(), random.direction()});
      features.push_back(static_cast<std::uint32_t>(i / 3));
      for (std::size_t k = 0; k < per_point; ++k)
        edges.edges.push_back(
            {static_cast<std::uint16_t>(random.below(360)), static_cast<std::uint16_t>(random.below(90))});
      edges.begin.push_back(static_cast<std::uint32_t>(edges.edges.size()));
    }
  }
  [[nodiscard]] Vec3 direction(std::size_t point, std::size_t k) const {
    const ShadowEdge edge = edges.of(point)[k];
    return ScanFrame(points[point].normal).direction(edge.azimuth, edge.elevation).cast<double>().normalized();
  }
};

Vec3 place_of_vote(const DomainVote& vote, std::span<const OrientedPoint> points) {
  return points[vote.point].position_world_m +
         std::sqrt(static_cast<double>(vote.squared_distance_m2)) * vote.direction.cast<double>();
}

TEST(DomainVotes, FollowTheInverseSquareLawOnEveryLayer) {
  const DrawnEdges drawn(12, 40, 1);
  const LightDomain domain = domain_over(ceiling(50, 3), Vec3::Zero(), {even_layers_m(3, 0.2), 8});
  std::vector<double> reflectance;
  for (std::size_t i = 0; i < drawn.points.size(); ++i) reflectance.push_back(0.1 + 0.05 * static_cast<double>(i));
  DomainVoteOptions options;
  options.reflectance = reflectance;
  options.reach_m = 30;
  const auto votes = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
  ASSERT_TRUE(votes);
  double expected = 0;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < drawn.points.size(); ++i) {
    for (std::size_t k = 0; k < 40; ++k) {
      const Vec3 d = drawn.direction(i, k);
      for (const double height_m : {3.0, 2.8, 2.6}) {
        const double distance_m = (height_m - drawn.points[i].position_world_m.z()) / d.z();
        if (d.z() <= 0 || distance_m > 30) continue;
        expected += reflectance[i] / (distance_m * distance_m);
        ++count;
      }
    }
  }
  double weight = 0;
  for (std::size_t c = 0; c < votes->cells.size(); ++c) {
    const DomainVotes::Cell& cell = votes->cells[c];
    EXPECT_FALSE(votes->of(c).empty());
    EXPECT_EQ(domain.cell_of(cell.centre_world_m, cell.cell.group), cell.cell);
    EXPECT_NEAR(cell.centre_world_m.z(), 3 - 0.2 * cell.layer, 1e-5);
    Vec3 sum = Vec3::Zero();
    double weights = 0, nearest_m = 1e9;
    for (const DomainVote& vote : votes->of(c)) {
      const Vec3 place = place_of_vote(vote, drawn.points);
      EXPECT_NEAR(place.z(), 3 - 0.2 * cell.layer, 1e-5);
      EXPECT_EQ(vote.feature, vote.point / 3);
      weight += votes->weight(vote);
      weights += votes->weight(vote);
      sum += votes->weight(vote) * place;
    }
    for (const DomainVote& vote : votes->of(c))
      nearest_m = std::min(nearest_m, (place_of_vote(vote, drawn.points) - sum / weights).norm());
    EXPECT_NEAR((cell.centre_world_m - sum / weights).norm(), nearest_m, 1e-6);
  }
  EXPECT_EQ(votes->votes.size(), count);
  EXPECT_EQ(votes->counts.votes, count);
  EXPECT_NEAR(weight / expected, 1, 1e-5);
  EXPECT_EQ(votes->features, 4u);
  EXPECT_EQ(votes->points_of_feature, (std::vector<std::uint32_t>{3, 3, 3, 3}));
}

TEST(DomainVotes, OccludersBlockExactlyThoseBehindThem) {
  const DrawnEdges drawn(20, 60, 2);
  const LightDomain domain = domain_over(ceiling(50, 3), Vec3::Zero());
  const Vec3 middle(0.3, -0.2, 0);
  const RayScene people(ceiling(0.8, 1.5, middle)), plinth(ceiling(0.4, 2, middle));
  DomainVoteOptions options;
  const auto open = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
  options.surroundings = {&plinth, &people};
  const auto blocked = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
  ASSERT_TRUE(open && blocked);
  const auto within = [&](const DomainVote& vote, double half_m, double height_m) {
    const Vec3& from = drawn.points[vote.point].position_world_m;
    const Vec3 at = from + (height_m - from.z()) / vote.direction.z() * vote.direction.cast<double>() - middle;
    return std::max(std::abs(at.x()), std::abs(at.y())) < half_m;
  };
  std::uint64_t by_plinth = 0, by_people = 0;
  std::vector<DomainVote> left;
  for (const DomainVote& vote : open->votes) {
    if (within(vote, 0.4, 2))
      ++by_plinth;
    else if (within(vote, 0.8, 1.5))
      ++by_people;
    else
      left.push_back(vote);
  }
  EXPECT_GT(by_plinth, 5u);
  EXPECT_GT(by_people, 5u);
  EXPECT_EQ(blocked->counts.behind_environment, by_plinth);
  EXPECT_EQ(blocked->counts.behind_occluders, by_people);
  ASSERT_EQ(blocked->votes.size(), left.size());
  EXPECT_EQ(std::memcmp(blocked->votes.data(), left.data(), left.size() * sizeof(DomainVote)), 0);
}

TEST(DomainVotes, LuminairesMayHangOnTheEnvironmentItself) {
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(1e6, 2e6, -500)}) {
    const DrawnEdges drawn(20, 60, 3, shift);
    Scene room = ceiling(50, 3);
    room.origin_world_m = shift;
    const RayScene environment(room);
    const LightDomain domain = domain_over(room, shift, {{0, 0.1}, 8});
    DomainVoteOptions options;
    const auto alone = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
    options.surroundings.environment = &environment;
    const auto flush = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
    ASSERT_TRUE(alone && flush);
    EXPECT_EQ(flush->counts.behind_environment, 0u);
    EXPECT_EQ(flush->votes.size(), alone->votes.size());
  }
}

/// A floor, a wall at x = 0 from z = 0 to 1, and an upper floor; long in y. A point of the lower floor at -w sees its
/// shadow edges along the wall's upper edge. So on a level surface at z = h every edge ends at x = w (h - 1), whatever
/// its azimuth.
struct WallAndPoints {
  Scene scene = parametric(3, 1, [](double u, double v) {
    const std::array<Vec3, 4> profile = {Vec3(-4, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(4, 0, 1)};
    const Vec3 at = profile[static_cast<std::size_t>(std::lround(3 * u))];
    return Vec3(at.x(), 400 * v - 200, at.z());
  });
  TargetRays target{scene};
  std::vector<OrientedPoint> points;
  ShadowEdges edges;
  std::vector<std::uint32_t> features;
  explicit WallAndPoints(double away_m) {
    for (int i = -20; i <= 20; ++i) {
      points.push_back({Vec3(-away_m, 0.02 * i, 0), Vec3::UnitZ()});
      features.push_back(static_cast<std::uint32_t>(i + 20) / 8);
    }
    edges = *find_shadow_edges(target, points, {});
  }
};

TEST(DomainVotes, GatherWhereAWallsGeometryPredicts) {
  const WallAndPoints wall(1);
  // A strip of ceiling wide enough for all |y| < 2.
  const Scene strip = parametric(2, 2, [](double u, double v) { return Vec3(-4 + 16 * v, 4 * u - 2, 3); });
  const LightDomain domain = domain_over(strip, Vec3(-1, 0, 0), {{0}, 16});
  const auto votes = vote_on_domain(domain, wall.edges, wall.points, wall.features, {});
  ASSERT_TRUE(votes);
  EXPECT_GT(votes->votes.size(), 1000u);
  for (const DomainVote& vote : votes->votes) {
    // The scan's step is a degree of elevation.
    const Vec3 place = place_of_vote(vote, wall.points);
    EXPECT_LT(place.x(), 2 + 1e-4);
    EXPECT_GT(place.x(), 2 - 0.17);
  }
  PotentialLightOptions options;
  options.beam_angle_rad = rad_from_deg(40);
  const auto lights = potential_lights(*votes, options);
  ASSERT_TRUE(lights);
  const auto best = std::max_element(lights->lights.begin(), lights->lights.end(),
                                     [](const auto& a, const auto& b) { return a.weight < b.weight; });
  EXPECT_NEAR(best->position_world_m.x(), 2 - 0.08, 0.1);
  EXPECT_NEAR(best->position_world_m.z(), 3, 1e-5);
  // It shines over the wall's edge back at the points.
  const Vec3 towards = (Vec3(-1, 0, 0) - best->position_world_m).normalized();
  EXPECT_GT(best->direction.dot(towards), std::cos(rad_from_deg(5)));
}

TEST(DomainVotes, AreBoundedInNumber) {
  const DrawnEdges drawn(40, 100, 4);
  const LightDomain domain = domain_over(ceiling(1000, 1), Vec3::Zero(), {even_layers_m(2), 4});
  DomainVoteOptions options;
  options.max_votes = 1000;
  const auto few = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
  ASSERT_TRUE(few);
  EXPECT_EQ(few->every, 8u);
  EXPECT_LE(few->votes.size(), 1000u);
  EXPECT_EQ(few->counts.rays, 500u);
  options.max_votes = 0;
  const auto all = vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options);
  EXPECT_EQ(all->counts.rays, 4000u);
}

TEST(DomainVotes, ReportWhyThereAreNone) {
  const DrawnEdges drawn(10, 20, 5);
  const LightDomain domain = domain_over(ceiling(1, 3), Vec3::Zero());
  const auto why = [&](const DrawnEdges& from, const DomainVoteOptions& options) {
    const auto votes = vote_on_domain(domain, from.edges, from.points, from.features, options);
    return votes ? std::string() : votes.error().detail;
  };
  EXPECT_NE(why(DrawnEdges(0, 0, 1), {}).find("no interest points"), std::string::npos);
  EXPECT_NE(why(DrawnEdges(10, 0, 1), {}).find("shadow edge"), std::string::npos);
  DomainVoteOptions options;
  options.reach_m = 1;
  EXPECT_NE(why(drawn, options).find("out of reach"), std::string::npos);
  EXPECT_EQ(why(drawn, options).find(" 0 out of reach"), std::string::npos);
  const RayScene lid(ceiling(100, 2));
  options = {};
  options.surroundings.environment = &lid;
  EXPECT_NE(why(drawn, options).find("behind the environment"), std::string::npos);
  EXPECT_EQ(why(drawn, options).find(" 0 behind the environment"), std::string::npos);
  DrawnEdges broken(10, 20, 5);
  broken.points[4].position_world_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(why(broken, {}).find("not finite"), std::string::npos);
  options = {};
  options.nearest_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(why(drawn, options), "");
  const std::vector<double> reflectance(drawn.points.size(), 1.5);
  options = {};
  options.reflectance = reflectance;
  EXPECT_NE(why(drawn, options), "");
  // A closed box from inside.
  Scene inside = uv_sphere(1, 12);
  for (auto& t : inside.triangles) std::swap(t[1], t[2]);
  const TargetRays target(inside);
  const auto surface = make_target_surface(inside);
  std::vector<OrientedPoint> points;
  for (std::uint32_t i = 20; i < 40; ++i) points.push_back({surface->point_world_m(i), surface->normals[i]});
  const auto edges = find_shadow_edges(target, points, {});
  const std::vector<std::uint32_t> features(points.size(), 0);
  const auto votes = vote_on_domain(domain, *edges, points, features, {});
  ASSERT_FALSE(votes);
  EXPECT_NE(votes.error().detail.find("blocks every direction"), std::string::npos);
  options = {};
  std::stop_source stop;
  stop.request_stop();
  options.watch.stop = stop.get_token();
  EXPECT_EQ(vote_on_domain(domain, drawn.edges, drawn.points, drawn.features, options).error().cause, Cause::cancelled);
}

TEST(DomainVotes, AreFiniteOrRefusedForDegenerateDomains) {
  Random random(21);
  for (unsigned round = 0; round < 60; ++round) {
    const Vec3 shift = round % 3 == 0 ? Vec3(0, 0, 0) : Vec3(1e6 * random.in_cube());
    DrawnEdges drawn(6, 30, round, shift);
    if (round % 4 == 1)  // the target's points in the domain's own plane
      for (OrientedPoint& point : drawn.points)
        point = {Vec3(point.position_world_m.x(), point.position_world_m.y(), shift.z()), Vec3::UnitZ()};
    Scene scene = ceiling(random.between(0.1, 3), round % 4 <= 1 ? 0.0 : random.between(-2, 2));
    scene.origin_world_m = shift;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t)
      if (random.below(3) == 0) scene.triangles[t][1] = scene.triangles[t][2];
    const auto domain = mesh_light_domain(scene, {}, shift, {even_layers_m(1 + static_cast<int>(random.below(3))), 8});
    if (!domain) continue;
    for (const auto& cell : domain->cell_centres()) EXPECT_TRUE(cell.position_world_m.allFinite());
    const auto votes = vote_on_domain(*domain, drawn.edges, drawn.points, drawn.features, {});
    if (!votes) {
      EXPECT_FALSE(votes.error().detail.empty());
      continue;
    }
    for (const DomainVote& vote : votes->votes) {
      EXPECT_TRUE(std::isfinite(votes->weight(vote)));
      EXPECT_LT(votes->weight(vote), 1e6 * (1 + 1e-6));  // distances count as at least 1 mm
      EXPECT_NEAR(vote.direction.norm(), 1, 1e-6);
    }
    PotentialLightOptions options;
    options.min_votes = 1;
    const auto lights = potential_lights(*votes, options);
    ASSERT_TRUE(lights);
    for (const PotentialLight& light : lights->lights) {
      EXPECT_NEAR(light.direction.norm(), 1, 1e-9);
      EXPECT_TRUE(light.position_world_m.allFinite() && std::isfinite(light.weight) && light.weight > 0);
    }
  }
}

TEST(CoverageVotes, ComeFromThePlacesThatSeeASphere) {
  const Scene scene = uv_sphere(0.5, 24);
  const TargetRays target(scene);
  const auto surface = make_target_surface(scene);
  const auto domain = nested_box_domain(*surface, {1, 1, 1, 4});
  CoverageVoteOptions options;
  options.max_points = 300;
  const auto covering = vote_for_coverage(*domain, *surface, target, options);
  ASSERT_TRUE(covering);
  std::uint64_t expected = 0, unsure = 0;
  double weight = 0, expected_weight = 0, area = 0;
  for (const std::uint32_t i : covering->surface_point) area += surface->areas_m2[i];
  for (const std::uint32_t i : covering->surface_point) {
    for (const auto& cell : domain->cell_centres()) {
      const Vec3 way = cell.position_world_m - surface->point_world_m(i);
      // Facets rise above their corners' horizon by up to half the angle between them.
      const double sine = way.normalized().dot(surface->normals[i]);
      if (std::abs(sine) < 0.15) {
        ++unsure;
        continue;
      }
      if (sine < 0) continue;
      ++expected;
      expected_weight += surface->areas_m2[i] / area / way.squaredNorm();
    }
  }
  for (const DomainVote& vote : covering->votes.votes) {
    const Vec3 normal = surface->normals[covering->surface_point[vote.point]];
    if (vote.direction.cast<double>().dot(normal) < 0.15) continue;
    --expected;
    weight += covering->votes.weight(vote);
  }
  EXPECT_EQ(expected, 0u);
  EXPECT_NEAR(weight / expected_weight, 1, 1e-5);
  EXPECT_LT(unsure, covering->votes.votes.size());
  options.reach_m = 0.9;
  EXPECT_FALSE(vote_for_coverage(*domain, *surface, target, options));
  const RayScene box(uv_sphere(0.8, 20));
  options = {};
  options.surroundings.occluders = &box;
  const auto none = vote_for_coverage(*domain, *surface, target, options);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().detail.find("behind occluders"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
