/// Direct light from luminaires with size and from skies, with obstacles in between.

#include <gtest/gtest.h>

#include <random>

#include "core/transport/direct/direct_light.h"
#include "core/transport/direct/shape_light.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/closed_forms.h"
#include "tests/core/transport/diffuser.h"
#include "tests/core/transport/direct/direct_shape_fixture.h"
#include "tests/core/transport/lamp_pose.h"

namespace luxrig {
namespace {

using namespace direct_shape_fixture;

using Kind = LuminousShape::Kind;

double standard_error(const DirectLight& light, Eigen::Index r, Eigen::Index e) {
  if (light.replicates.empty()) return 0;
  double sum2 = 0;
  for (const auto& one : light.replicates) sum2 += std::pow(one(r, e) - light.lux_per_level(r, e), 2);
  const auto n = static_cast<double>(light.replicates.size());
  return std::sqrt(sum2 / (n * (n - 1)));
}

TEST(DirectShapeLight, ALampFlushWithTheCeilingIsExactWithoutRays) {
  for (const int split : {1, 8}) {
    Builder room;
    room.box({-2, -1.5, 0}, {2, 1.5, 2.7}, split);
    std::vector<Receiver> receivers;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 40; ++i) {
      receivers.push_back({{2 * unit(random), 1.5 * unit(random), 0}, Vec3::UnitZ()});     // on the floor
      receivers.push_back({{-2, 1.5 * unit(random), 1.3 + unit(random)}, Vec3::UnitX()});  // on a wall
      receivers.push_back({{2 * unit(random), 1.5 * unit(random), 0.75}, Vec3::UnitZ()});  // in the air
    }
    receivers.push_back({{-2, -1.5, 0}, Vec3::UnitZ()});  // in a corner
    const std::vector<Emitter> emitters = {
        {diffuser(0.72), {Mat3::Identity(), {0.5, 0.2, 2.7}}, rectangle(1.2, 0.6)},
        {diffuser(kPi / 4), {Mat3::Identity(), {-1, 0.2, 2.7}}, {Kind::disk, {1, 0, 0}}}};
    const auto light = direct(room.done(), receivers, emitters);
    EXPECT_EQ(light.rays, 0u);
    EXPECT_TRUE(light.replicates.empty());
    EXPECT_EQ(light.relative_error, 0);
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      const auto& [p, n] = receivers[r];
      const double expected = rectangle_form(-0.1, 1.1, -0.1, 0.5, 2.7, p, n);
      EXPECT_NEAR(light.lux_per_level(static_cast<Eigen::Index>(r), 0), expected, 2e-5 * expected);
      if (n == Vec3::UnitZ()) {
        const double disk = parallel_disk_form(0.5, 2.7 - p.z(), (p - Vec3(-1, 0.2, p.z())).norm());
        EXPECT_NEAR(light.lux_per_level(static_cast<Eigen::Index>(r), 1), disk, 2e-5 * disk);
      }
    }
  }
}

TEST(DirectShapeLight, PendantsOfAnyKindInAnEmptyRoomNeedNoRay) {
  Builder room;
  room.box({-2, -1.5, 0}, {2, 1.5, 2.7}, 3);
  const Scene scene = room.done();
  const std::vector<Receiver> receivers = {{{0.3, 0.2, 0}, Vec3::UnitZ()},
                                           {{2, 1.2, 0.4}, -Vec3::UnitX()},
                                           {{1, 1.5, 2.6}, -Vec3::UnitY()},
                                           {{-1.3, 0.2, 0.7}, Vec3(1, 0.3, 1).normalized()}};
  std::vector<Emitter> emitters;
  for (const Kind kind : {Kind::rectangle, Kind::disk, Kind::sphere, Kind::cylinder})
    emitters.push_back({make_isotropic(1000), lamp_at({0.2, 0.1, 1.9}, {0.5, 0.6, 0}), {kind, {0.3, 0.2, 0.5}}});
  const auto light = direct(scene, receivers, emitters);
  EXPECT_EQ(light.rays, 0u);
  EXPECT_TRUE(light.replicates.empty());
  for (Eigen::Index r = 0; r < 4; ++r)
    for (Eigen::Index e = 0; e < 4; ++e) {
      const auto& [p, n] = receivers[static_cast<std::size_t>(r)];
      EXPECT_EQ(light.lux_per_level(r, e), shape_light(p, n, emitters[static_cast<std::size_t>(e)]).lux);
    }
}

TEST(DirectShapeLight, APartlyHiddenLampIsSampledToTheWantedErrorHonestly) {
  std::uint64_t rays_before = 0;
  for (const double wanted : {0.03, 0.01, 0.003}) {
    int within_two = 0, runs = 0;
    std::uint64_t rays = 0;
    for (int i = 0; i < 200; ++i) {
      const HalfHidden half(-0.7 + 0.007 * i + 0.0013);
      EvaluateOptions options;
      options.wanted_relative_error = wanted;
      options.seed = 100 + static_cast<std::uint64_t>(i);
      const auto light = direct(half.scene, half.receivers, half.emitters, options);
      ASSERT_EQ(light.replicates.size(), 16u);
      EXPECT_LE(light.relative_error, wanted);
      EXPECT_GT(light.relative_error, 0);
      const double error = standard_error(light, 0, 0), off = std::abs(light.lux_per_level(0, 0) - half.expected());
      EXPECT_LT(off, 2 * wanted * half.expected()) << half.at_x_m;
      within_two += off <= 2 * 1.09 * error;
      ++runs;
      rays += light.rays;
    }
    EXPECT_GE(within_two, 0.9 * runs) << wanted;
    EXPECT_GT(rays, rays_before) << "a smaller error takes more rays";
    rays_before = rays;
  }
}

TEST(DirectShapeLight, AWhollyHiddenLampIsProvenDarkWithARayPerCorner) {
  for (const int split : {1, 6}) {
    Builder wall;
    wall.quad({-4, -5, 1}, {4, -5, 1}, {4, 5, 1}, {-4, 5, 1}, split);
    const std::vector<Receiver> receivers = {{{0.1, 0.3, 0}, Vec3::UnitZ()}, {{0.5, -2, 0}, Vec3::UnitZ()}};
    const std::vector<Emitter> emitters = {
        {diffuser(1), {Mat3::Identity(), {0, 0, 2}}, rectangle(1.6, 1)},
        {diffuser(1), {Mat3::Identity(), {0.4, 0, 2.5}}, {Kind::cylinder, {0.1, 0, 1}}}};
    const auto light = direct(wall.done(), receivers, emitters);
    EXPECT_EQ(light.lux_per_level.maxCoeff(), 0);
    if (split == 1) {
      EXPECT_LE(light.rays, 2u * (4 + 8));
      EXPECT_TRUE(light.replicates.empty());
    }
  }
}

TEST(DirectShapeLight, AWallWithAHoleIsNotTakenAsSolid) {
  // All four corners of the lamp are behind the wall; light comes through a hole in its middle.
  Builder wall;
  wall.quad({-4, -4, 1}, {-0.1, -4, 1}, {-0.1, 4, 1}, {-4, 4, 1});
  wall.quad({0.1, -4, 1}, {4, -4, 1}, {4, 4, 1}, {0.1, 4, 1});
  wall.quad({-0.1, -4, 1}, {0.1, -4, 1}, {0.1, -0.1, 1}, {-0.1, -0.1, 1});
  wall.quad({-0.1, 0.1, 1}, {0.1, 0.1, 1}, {0.1, 4, 1}, {-0.1, 4, 1});
  const std::vector<Receiver> receivers = {{{0, 0, 0}, Vec3::UnitZ()}};
  const std::vector<Emitter> emitters = {{diffuser(1.6), {Mat3::Identity(), {0, 0, 2}}, rectangle(1.6, 1)}};
  const auto light = direct(wall.done(), receivers, emitters);
  const double expected = rectangle_form(-0.1, 0.1, -0.1, 0.1, 1, Vec3::Zero(), Vec3::UnitZ());
  EXPECT_NEAR(light.lux_per_level(0, 0), expected, 4 * standard_error(light, 0, 0));
  EXPECT_LE(light.relative_error, 0.01);
}

TEST(DirectShapeLight, LampsThatCannotContributeCastNoRay) {
  Builder clutter;  // in the way of every lamp
  clutter.quad({-0.3, -0.3, 1}, {0.3, -0.3, 1}, {0.3, 0.3, 1}, {-0.3, 0.3, 1});
  clutter.quad({-0.3, -0.3, -1}, {0.3, -0.3, -1}, {0.3, 0.3, -1}, {-0.3, 0.3, -1});
  const Scene scene = clutter.done();
  const Receiver up{{0, 0, 0}, Vec3::UnitZ()};
  const auto rays = [&](const Emitter& emitter) { return direct(scene, {up}, {emitter}).rays; };
  const Intensity spot = make_spot(1000, rad_from_deg(20), rad_from_deg(30));
  for (const Kind kind : {Kind::rectangle, Kind::disk, Kind::sphere, Kind::cylinder}) {
    const LuminousShape shape{kind, {0.8, 0.8, 0.8}};
    EXPECT_GT(rays({make_isotropic(100), {Mat3::Identity(), {0, 0, 2}}, shape}), 0u);
    EXPECT_EQ(rays({make_isotropic(100), {Mat3::Identity(), {0, 0, -2}}, shape}), 0u) << "behind";
    EXPECT_GT(rays({spot, lamp_at({0, 0, 2}, {0, 0, 0}), shape}), 0u);
    EXPECT_EQ(rays({spot, lamp_at({0, 0, 2}, {0, 0, 9}), shape}), 0u) << "aimed away";
    EXPECT_EQ(rays({spot, lamp_at({6, 0, 2}, {6, 0, 0}), shape}), 0u) << "aimed beside";
  }
}

TEST(DirectShapeLight, PointLampsStayExactBesideSampledOnes) {
  HalfHidden half(0.1);
  half.emitters.push_back({make_isotropic(500), {Mat3::Identity(), {1, 0, 2}}});
  half.receivers.push_back({{3, 0, 0}, Vec3::UnitZ()});
  const auto light = direct(half.scene, half.receivers, half.emitters);
  ASSERT_EQ(light.replicates.size(), 16u);
  for (const auto& replicate : light.replicates)
    for (Eigen::Index r = 0; r < 2; ++r) EXPECT_EQ(replicate(r, 1), light.lux_per_level(r, 1));
  EXPECT_DOUBLE_EQ(light.lux_per_level(0, 1), 500 / (4 * kPi) * 2 / std::pow(5, 1.5));
  // The mean of the replicates is the value.
  double mean = 0;
  for (const auto& replicate : light.replicates) mean += replicate(0, 0) / 16;
  EXPECT_NEAR(mean, light.lux_per_level(0, 0), 1e-12 * mean);
}

TEST(DirectShapeLight, LevelsSteerTheEffort) {
  HalfHidden half(0.1);
  half.emitters.push_back({make_isotropic(1e6), {Mat3::Identity(), {0.5, 0, 3}}});
  EvaluateOptions options;
  options.wanted_relative_error = 0.002;
  const auto outshone = direct(half.scene, half.receivers, half.emitters, options);
  options.levels = {1, 0};
  const auto alone = direct(half.scene, half.receivers, half.emitters, options);
  EXPECT_GT(alone.rays, 4 * outshone.rays);
  EXPECT_NEAR(alone.lux_per_level(0, 0), outshone.lux_per_level(0, 0), 4 * standard_error(outshone, 0, 0));
}

TEST(DirectShapeLight, NoLightPassesAWallBetweenClosedRooms) {
  Builder rooms;
  rooms.box({0, 0, 0}, {4, 3, 2.7}, 2);
  rooms.box({4.15, 0, 0}, {8, 3, 2.7}, 2);
  std::vector<Emitter> emitters;
  for (const Kind kind : {Kind::point, Kind::rectangle, Kind::disk, Kind::sphere, Kind::cylinder}) {
    emitters.push_back({make_isotropic(5000), lamp_at({2, 1.5, 2.2}, {2, 1.5, 0}), {kind, {0.6, 0.4, 0.3}}});
    emitters.push_back({make_isotropic(5000), lamp_at({3.69, 0.31, 2.3}, {3.6, 0.4, 0}), {kind, {0.6, 0.6, 0.6}}});
  }
  emitters.push_back({nullptr, {}, {}, Vec3::Ones(), std::make_shared<UniformSky>(5000)});
  std::vector<Receiver> receivers;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 30; ++i) {
    receivers.push_back({{4.15 + 3.85 * unit(random), 3 * unit(random), 0}, Vec3::UnitZ()});
    receivers.push_back({{4.15, 3 * unit(random), 2.7 * unit(random)}, Vec3::UnitX()});  // on the wall itself
    receivers.push_back({{8, 3 * unit(random), 2.7 * unit(random)}, -Vec3::UnitX()});
    receivers.push_back(
        {{4.15, i % 2 ? 0.0 : 3.0, i % 3 ? 0.0 : 2.7}, -Vec3(-1, i % 2 ? -1 : 1, i % 3 ? -1 : 1).normalized()});
  }
  const auto light = direct(rooms.done(), receivers, emitters);
  EXPECT_EQ(light.lux_per_level.maxCoeff(), 0);
}

TEST(DirectShapeLight, AnUnobstructedSkyLightsPlanesByTheShareTheySee) {
  const std::vector<Emitter> sky = {{nullptr, {}, {}, Vec3::Ones(), std::make_shared<UniformSky>(1000)}};
  for (const bool with_ground : {false, true}) {
    Builder ground;
    if (with_ground) ground.quad({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
    const auto level = direct(ground.done(), {{{1, 2, 0}, Vec3::UnitZ()}}, sky);
    EXPECT_EQ(level.lux_per_level(0, 0), 1000 * kPi);
    EXPECT_EQ(level.rays, 0u);
    for (const double tilt_deg : {20.0, 60.0, 90.0, 150.0}) {
      const double tilt = rad_from_deg(tilt_deg);
      const auto light = direct(ground.done(), {{{0, 0, 1}, {std::sin(tilt), 0, std::cos(tilt)}}}, sky);
      const double expected = 1000 * kPi * (1 + std::cos(tilt)) / 2;
      EXPECT_NEAR(light.lux_per_level(0, 0), expected, 4 * standard_error(light, 0, 0)) << tilt_deg;
      EXPECT_LE(light.relative_error, 0.01);
      if (!with_ground) {
        EXPECT_EQ(light.rays, 0u);
      }
    }
  }
}

TEST(DirectShapeLight, DaylightThroughAnOpeningMatchesItsConfigurationFactor) {
  // A closed room with a skylight of 1 m × 0.5 m in its roof, and one with a window in a wall.
  Builder roof;
  roof.quad({-2, -2, 3}, {-0.5, -2, 3}, {-0.5, 2, 3}, {-2, 2, 3});
  roof.quad({0.5, -2, 3}, {2, -2, 3}, {2, 2, 3}, {0.5, 2, 3});
  roof.quad({-0.5, -2, 3}, {0.5, -2, 3}, {0.5, -0.25, 3}, {-0.5, -0.25, 3});
  roof.quad({-0.5, 0.25, 3}, {0.5, 0.25, 3}, {0.5, 2, 3}, {-0.5, 2, 3});
  for (const auto& [x, y] : {std::pair{-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
    const Vec3 middle(x, y, 1.5), along = 2 * Vec3(y, x, 0).normalized(), up(0, 0, 1.5);
    roof.quad(middle - along - up, middle + along - up, middle + along + up, middle - along + up);
  }
  const Scene scene = roof.done();
  std::vector<Receiver> receivers;
  for (const double x : {-1.5, 0.0, 0.7, 1.9})
    for (const double y : {-1.0, 0.2}) receivers.push_back({{x, y, 0.8}, Vec3::UnitZ()});
  receivers.push_back({{-2, 0.3, 1.2}, Vec3::UnitX()});
  const std::vector<Emitter> sky = {{nullptr, {}, {}, Vec3::Ones(), std::make_shared<UniformSky>(1000)}};
  EvaluateOptions options;
  options.wanted_relative_error = 0.02;
  const auto light = direct(scene, receivers, sky, options);
  EXPECT_LE(light.relative_error, 0.02);
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    const double expected =
        1000 * rectangle_form(-0.5, 0.5, -0.25, 0.25, 3, receivers[r].position_world_m, receivers[r].normal_world);
    const auto row = static_cast<Eigen::Index>(r);
    EXPECT_NEAR(light.lux_per_level(row, 0), expected, 4 * standard_error(light, row, 0)) << r;
  }
}

TEST(DirectShapeLight, StopsAtTheMaximumOfRaysAndReportsItsError) {
  const HalfHidden half(0.1);
  EvaluateOptions options;
  options.wanted_relative_error = 1e-7;
  options.max_rays = 100'000;
  const auto light = direct(half.scene, half.receivers, half.emitters, options);
  EXPECT_LE(light.rays, options.max_rays);
  EXPECT_GT(light.rays, options.max_rays / 4);
  EXPECT_GT(light.relative_error, 1e-7);
}

TEST(DirectShapeLight, StopsWhenAskedWhileSampling) {
  const HalfHidden half(0.1);
  std::stop_source stop;
  EvaluateOptions options;
  options.wanted_relative_error = 1e-12;
  options.watch.stop = stop.get_token();
  options.watch.progress = [&](double) { stop.request_stop(); };
  const RayScene rays(half.scene);
  const auto result = direct_light(rays, half.receivers, half.emitters, options);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().cause, Cause::cancelled);
}

TEST(DirectShapeLight, ColoursAddUpToTheLuminance) {
  HalfHidden half(0.1);
  half.emitters[0].colour_rgb = {1.2, 1, 0.411};
  half.emitters[0].colour_rgb /= half.emitters[0].colour_rgb.dot(Vec3(0.2126, 0.7152, 0.0722));
  half.emitters.push_back({make_isotropic(500), {Mat3::Identity(), {1, 0, 2}}});
  const RayScene rays(half.scene);
  EvaluateOptions options;
  const auto plain = make_direct_evaluator(rays)->evaluate(half.receivers, half.emitters, options);
  ASSERT_TRUE(plain.has_value());
  EXPECT_TRUE(plain->rgb_per_level.empty());
  options.colour = true;
  const auto coloured = make_direct_evaluator(rays)->evaluate(half.receivers, half.emitters, options);
  ASSERT_TRUE(coloured.has_value());
  ASSERT_EQ(coloured->rgb_per_level.size(), 3u);
  EXPECT_EQ(coloured->lux_per_level, plain->lux_per_level);
  const Eigen::MatrixXd sum =
      0.2126 * coloured->rgb_per_level[0] + 0.7152 * coloured->rgb_per_level[1] + 0.0722 * coloured->rgb_per_level[2];
  EXPECT_LT((sum - coloured->lux_per_level).cwiseAbs().maxCoeff(), 1e-12 * sum.maxCoeff());
  EXPECT_EQ(coloured->rgb_per_level[0](0, 0), coloured->lux_per_level(0, 0) * half.emitters[0].colour_rgb.x());
}

}  // namespace
}  // namespace luxrig
