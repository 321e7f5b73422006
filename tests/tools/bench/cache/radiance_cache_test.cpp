#include "tools/bench/cache/radiance_cache.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/transport/cube_radiosity.h"
#include "tests/core/transport/lamp_pose.h"
#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/radiance_cache_fixture.h"

namespace luxrig {
namespace {

using namespace radiance_cache_fixture;

TEST(RadianceCache, AClosedCubeReceivesFluxOverOneMinusReflectance) {
  const auto receivers = receivers_of(cube_wall_grid(3, 6));
  for (const double reflectance : {0.2, 0.5, 0.8}) {
    const Scene cube = make_cube(3, reflectance);
    const auto matrix = cached(cube, receivers, {bulb_at({0.3, -0.2, 0.4})}, quick_sides());
    ASSERT_EQ(matrix.receivers(), 216);
    const double expected_lx = mean_wall_illuminance_lx(1000, area_m2(cube), reflectance);
    EXPECT_NEAR(matrix.lux_per_level.mean(), expected_lx, 0.02 * expected_lx) << "reflectance " << reflectance;
  }
}

TEST(RadianceCache, AgreesWithRadiosityInACubeWithinThreePercentAndItsError) {
  const double reflectance = 0.6, edge_m = 2;
  const Vec3 source_m(0.35, -0.2, 0.45);
  const Scene cube = make_cube(edge_m, reflectance);
  std::vector<Receiver> receivers = receivers_of(cube_wall_grid(edge_m, 7));
  std::erase_if(receivers, [](const Receiver& r) { return (r.position_world_m.cwiseAbs().array() > 0.8).count() > 1; });
  const auto matrix = cached(cube, receivers, {bulb_at(source_m)}, {});
  const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
  const CubeRadiosity reference(edge_m, reflectance, 1000, source_m, 12);
  Eigen::Index within = 0;
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
    const Receiver& receiver = receivers[static_cast<std::size_t>(r)];
    const double expected_lx =
        reference.reflected_lx(receiver.position_world_m, receiver.normal_world) + matrix.direct_lux_per_level(r, 0);
    const double off_lx = std::abs(matrix.lux_per_level(r, 0) - expected_lx);
    EXPECT_LT(off_lx, 0.05 * expected_lx);
    within += off_lx < 2 * error_lx[r];
  }
  EXPECT_GT(static_cast<double>(within), 0.9 * static_cast<double>(matrix.receivers()));
}

TEST(RadianceCache, NoLightPassesAWallBetweenClosedRooms) {
  const Scene scene = two_rooms(0.9);
  std::vector<Receiver> receivers;
  for (double y = 0.1; y < 2; y += 0.3)
    for (const double z : {0.001, 0.5, 1.9}) receivers.push_back({{2.2, y, z}, Vec3::UnitZ()});
  for (const int voxels : {32, 64, 128}) {
    CacheSettings settings = quick_sides();
    settings.voxels = voxels;
    const auto matrix = cached(scene, receivers, {bulb_at({1.9, 1, 1}), bulb_at({3, 1, 1})}, settings);
    ASSERT_EQ(matrix.emitters(), 2);
    EXPECT_LT(matrix.lux_per_level.col(0).maxCoeff(), 1e-6) << voxels;
    EXPECT_GT(matrix.lux_per_level.col(1).minCoeff(), 100);
  }
}

TEST(RadianceCache, ALargeGroundOutsideDoesNotChangeARoomsLight) {
  std::vector<Receiver> receivers;
  for (double x = 0.5; x < 6; x += 0.8)
    for (double y = 0.5; y < 5; y += 0.8) receivers.push_back({{x, y, 0.8}, Vec3::UnitZ()});
  const std::vector<Emitter> bulbs = {bulb_at({1.5, 3, 2.3}), bulb_at({4.5, 1.5, 2.3})};
  EvaluateOptions options;
  options.wanted_relative_error = 0.005;
  for (const double half_m : {12.0, 100.0, 1000.0}) {
    const Scene scene = room_open_to_a_ground(half_m, 0.6);
    const RayScene rays(scene);
    const auto paths = make_path_evaluator(rays)->evaluate(receivers, bulbs, options);
    ASSERT_TRUE(paths);
    const auto matrix = cached(scene, receivers, bulbs, {});
    ASSERT_EQ(matrix.receivers(), static_cast<Eigen::Index>(receivers.size()));
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(2), truth_lx = paths->lux(levels);
    const Eigen::VectorXd off = (matrix.lux(levels) - truth_lx).cwiseQuotient(truth_lx);
    EXPECT_LT(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), 0.02) << half_m << " m";
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.06) << half_m << " m";
    EXPECT_LT(matrix.relative_error, 0.05) << half_m << " m";
  }
}

TEST(RadianceCache, IsRefusedForWallsThinnerThanRounding) {
  const Scene scene = room_open_to_a_ground(10'000, 0.6);
  const RayScene rays(scene);
  const std::vector<Receiver> receivers = {{{3, 2, 0.8}, Vec3::UnitZ()}, {{1, 4, 0.8}, Vec3::UnitZ()}};
  const auto cache = RadianceCache::build(scene, rays, receivers, quick_sides(), {});
  ASSERT_FALSE(cache);
  EXPECT_NE(cache.error().detail.find("both sides of a wall"), std::string::npos) << cache.error().detail;
  EXPECT_EQ(cache.error().cause, Cause::invalid);
}

TEST(RadianceCache, RefusesGlass) {
  Scene cube = make_cube(2, 0.5);
  cube.panes = {{{Vec3(-2, -2, 0), Vec3(2, -2, 0), Vec3(2, 2, 0)}, 0.9, 0}};
  const RayScene rays(cube);
  const auto cache = RadianceCache::build(cube, rays, receivers_of(cube_wall_grid(2, 3)), quick_sides(), {});
  ASSERT_FALSE(cache);
  EXPECT_NE(cache.error().detail.find("glass"), std::string::npos) << cache.error().detail;
}

TEST(RadianceCache, WithoutReflectanceGivesDirectLightOnly) {
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  for (const CacheSettings& settings : all_kinds()) {
    const auto matrix = cached(make_cube(2, 0), receivers, {bulb_at({0.1, 0.2, 0.3})}, settings);
    EXPECT_EQ(matrix.lux_per_level, matrix.direct_lux_per_level);
    EXPECT_LT(matrix.relative_error, 1e-12);
  }
}

TEST(RadianceCache, ColumnsMatchSingleEmittersInAnyOrder) {
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  const Scene cube = make_cube(2, 0.6);
  const RayScene rays(cube);
  const std::vector<Emitter> emitters = {
      bulb_at({0.1, 0.2, 0.3}),
      {make_spot(900, rad_from_deg(36), rad_from_deg(60)), lamp_at({0.5, 0.4, 0.9}, {0.4, 0.3, -1})},
      bulb_at({-0.6, 0.2, -0.3}, 200)};
  for (const CacheSettings& settings : all_kinds()) {
    const auto cache = RadianceCache::build(cube, rays, receivers, settings, {});
    ASSERT_TRUE(cache.has_value());
    const auto all = cache->evaluate(emitters, {});
    ASSERT_TRUE(all.has_value());
    const std::vector<Emitter> turned = {emitters[2], emitters[0], emitters[1]};
    const auto other = cache->evaluate(turned, {});
    for (int e = 0; e < 3; ++e) {
      const auto alone = cache->evaluate(std::span(emitters).subspan(static_cast<std::size_t>(e), 1), {});
      EXPECT_EQ(alone->lux_per_level.col(0), all->lux_per_level.col(e));
      EXPECT_EQ(other->lux_per_level.col((e + 1) % 3), all->lux_per_level.col(e));
      for (std::size_t k = 0; k < kCacheReplicates; ++k)
        EXPECT_EQ(alone->replicates[k].col(0), all->replicates[k].col(e));
    }
  }
}

TEST(RadianceCache, UnneededCellsCanBeOmittedWithoutChange) {
  // The outer faces of the cube and a second room behind a wall are near surfaces, but their cells are not needed.
  const Scene scene = two_rooms(0.6);
  std::vector<Receiver> receivers = {{{0.5, 0.5, 0.01}, Vec3::UnitZ()}, {{1, 1.2, 0.75}, Vec3::UnitZ()}};
  const RayScene rays(scene);
  for (CacheSettings settings : all_kinds()) {
    // Exact traversals only: a march through walls would reach the other room.
    settings.first_visibility = settings.link_traversal = Traversal::rays;
    settings.open_places = true;
    settings.voxels = 64;
    const auto few = RadianceCache::build(scene, rays, receivers, settings, {});
    settings.only_needed = false;
    const auto all = RadianceCache::build(scene, rays, receivers, settings, {});
    ASSERT_TRUE(few && all);
    // At a wall's corners, cells of directions reach through it; sides do not.
    const double most = settings.contents == CacheContents::sides ? 0.5 : 0.95;
    EXPECT_LT(few->report().cells, most * static_cast<double>(all->report().cells));
    EXPECT_LT(few->report().rays, all->report().rays);
    const std::vector<Emitter> emitters = {bulb_at({1, 1, 1.5})};
    const auto a = few->evaluate(emitters, {}), b = all->evaluate(emitters, {});
    EXPECT_LT((a->lux_per_level - b->lux_per_level).cwiseAbs().maxCoeff(), 5e-4 * a->lux_per_level.maxCoeff());
  }
}

TEST(RadianceCache, MoreReflectionsAddLight) {
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  for (CacheSettings settings : all_kinds()) {
    double last = 0;
    for (const int reflections : {1, 2, 3, 0}) {
      settings.reflections = reflections;
      const auto matrix = cached(make_cube(2, 0.6), receivers, {bulb_at({0.1, 0.2, 0.3})}, settings);
      const double reflected = (matrix.lux_per_level - matrix.direct_lux_per_level).mean();
      EXPECT_GT(reflected, last);
      last = reflected;
    }
  }
}

TEST(RadianceCache, OneReflectionInACubeGivesItsShareOfTheFlux) {
  // Of the flux Φ that falls on the walls, ρΦ leaves them and falls on them again.
  const auto receivers = receivers_of(cube_wall_grid(2, 8));
  CacheSettings settings = quick_sides();
  settings.reflections = 1;
  const auto matrix = cached(make_cube(2, 0.6), receivers, {bulb_at({0.1, 0.2, 0.3})}, settings);
  const double reflected_lx = (matrix.lux_per_level - matrix.direct_lux_per_level).mean();
  EXPECT_NEAR(reflected_lx, 0.6 * 1000 / 24, 0.02 * 0.6 * 1000 / 24);
}

TEST(RadianceCache, ColoursAddUpToTheLuminanceAndGreyWallsKeepTheLampsColour) {
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  Emitter warm = bulb_at({0.1, 0.2, 0.3});
  warm.colour_rgb = Vec3(1.6, 0.9, 0.3);
  warm.colour_rgb /= 0.2126 * 1.6 + 0.7152 * 0.9 + 0.0722 * 0.3;
  EvaluateOptions options;
  options.colour = true;
  for (const CacheSettings& settings : all_kinds()) {
    for (const bool grey : {true, false}) {
      Scene scene = make_cube(2, 0.6);
      if (!grey) scene.materials[0].reflectance_rgb = {0.8, 0.4, 0.2};
      const auto matrix = cached(scene, receivers, {warm}, settings, options);
      ASSERT_EQ(matrix.rgb_per_level.size(), 3u);
      const Eigen::MatrixXd sum =
          0.2126 * matrix.rgb_per_level[0] + 0.7152 * matrix.rgb_per_level[1] + 0.0722 * matrix.rgb_per_level[2];
      EXPECT_LT((sum - matrix.lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * sum.maxCoeff());
      const double red = matrix.rgb_per_level[0].sum() / matrix.lux_per_level.sum();
      if (grey)
        EXPECT_NEAR(red, warm.colour_rgb[0], 1e-9);
      else
        EXPECT_GT(red, 1.05 * warm.colour_rgb[0]) << "reddish walls";
    }
  }
}

TEST(RadianceCache, ColouredWallsReflectEachPrimaryByItsOwnReflectance) {
  const auto receivers = receivers_of(cube_wall_grid(2, 6));
  Scene scene = make_cube(2, 0.5);
  scene.materials[0].reflectance_rgb = {0.8, 0.5, 0.2};
  EvaluateOptions options;
  options.colour = true;
  const auto matrix = cached(scene, receivers, {bulb_at({0.1, 0.2, 0.3})}, quick_sides(), options);
  for (int c = 0; c < 3; ++c) {
    const double expected_lx = mean_wall_illuminance_lx(1000, 24, scene.materials[0].reflectance_rgb[c]);
    EXPECT_NEAR(matrix.rgb_per_level[static_cast<std::size_t>(c)].mean(), expected_lx, 0.02 * expected_lx);
  }
}

TEST(RadianceCache, OddScenesGiveFiniteLightNoLessThanDirect) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto any = [&] { return Vec3f(unit(random), unit(random), unit(random)); };
  int refused = 0;
  for (int round = 0; round < 40; ++round) {
    const double scale = std::pow(10, round % 8 - 3);
    Scene scene;
    scene.materials = {{"paint", Vec3(0.8, 0.5, 0.2)}};
    const int triangles = round % 5 == 0 ? 1 : 12;
    for (int t = 0; t < triangles; ++t) {
      const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
      Vec3f a = any(), b = any(), c = any();
      if (t % 6 == 1) c = a + (b - a) * 0.5f;                                                         // no area
      if (t % 6 == 2) c = b + Vec3f(1e-6f, 0, 0);                                                     // a sliver
      if (t % 6 == 3 && first > 0) a = scene.vertices_m[first - 3], b = scene.vertices_m[first - 2];  // a shared edge
      if (t % 6 == 4) a.z() = b.z() = c.z() = 0;  // coplanar with the next like it
      for (const Vec3f& v : {a, b, c}) scene.vertices_m.push_back(v * (t == 0 ? 1 : static_cast<float>(scale)));
      scene.triangles.push_back({first, first + 1, first + 2});
      scene.material_of_triangle.push_back(0);
    }
    for (Vec3f& v : scene.vertices_m) v *= static_cast<float>(scale);
    std::vector<Receiver> receivers;
    std::vector<Emitter> emitters;
    for (int i = 0; i < 4; ++i) {
      receivers.push_back({any().cast<double>() * scale, any().cast<double>().normalized()});
      emitters.push_back(bulb_at(any().cast<double>() * scale));
    }
    receivers.push_back({scene.vertices_m[0].cast<double>(), Vec3::UnitZ()});
    for (CacheSettings settings : all_kinds()) {
      settings.voxels = 24;
      settings.gather_rays = settings.light_samples = 32;
      const auto matrix = cached(scene, receivers, emitters, settings);
      // All triangles but the first are so much larger than the lit part that cells cannot separate them.
      if (settings.contents == CacheContents::sides && scale >= 1000 && matrix.receivers() == 0) {
        ++refused;
        continue;
      }
      ASSERT_EQ(matrix.receivers(), 5) << round;
      EXPECT_TRUE(matrix.lux_per_level.allFinite()) << round;
      EXPECT_GE((matrix.lux_per_level - matrix.direct_lux_per_level).minCoeff(), 0) << round;
      for (const auto& replicate : matrix.replicates) EXPECT_TRUE(replicate.allFinite()) << round;
    }
  }
  EXPECT_LE(refused, 10) << "of 40";
}

TEST(RadianceCache, VoxelExactTraversalsGiveTheSameLight) {
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  Scene scene = make_cube(2, 0.6);
  add_box(scene, {-0.3, -0.2, -1}, {0.2, 0.4, 0.1});
  CacheSettings settings = quick_directions();
  settings.first_visibility = settings.link_traversal = Traversal::walk;
  const auto walked = cached(scene, receivers, {bulb_at({0.5, 0.6, 0.3})}, settings);
  settings.first_visibility = settings.link_traversal = Traversal::distance;
  const auto strode = cached(scene, receivers, {bulb_at({0.5, 0.6, 0.3})}, settings);
  EXPECT_LT((walked.lux_per_level - strode.lux_per_level).cwiseAbs().maxCoeff(),
            1e-3 * walked.lux_per_level.maxCoeff());
}

TEST(RadianceCache, SettingsOutOfRangeAreRefusedByName) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  CacheSettings settings;
  settings.voxels = 3;
  const auto refused = RadianceCache::build(cube, rays, {}, settings, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().cause, Cause::invalid);
  EXPECT_NE(refused.error().detail.find("voxels is 3"), std::string::npos) << refused.error().detail;
}

TEST(RadianceCache, BuildingStopsWhenAsked) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  const auto receivers = receivers_of(cube_wall_grid(2, 3));
  std::stop_source stop;
  stop.request_stop();
  for (const CacheSettings& settings : all_kinds()) {
    RadianceCache::BuildOptions options;
    options.watch.stop = stop.get_token();
    const auto stopped = RadianceCache::build(cube, rays, receivers, settings, options);
    ASSERT_FALSE(stopped.has_value());
    EXPECT_EQ(stopped.error().cause, Cause::cancelled);
  }
}

}  // namespace
}  // namespace luxrig
