#include "core/transport/sky/sky_openings.h"

#include <gtest/gtest.h>

#include <random>

#include "core/photometry/sky/sky.h"
#include "core/transport/sky/sky_opening_finder.h"
#include "tests/core/transport/closed_forms.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/sky/sky_openings_fixture.h"

namespace luxrig {
namespace {

using namespace sky_openings_fixture;

TEST(SkyOpenings, LinesWithTheirDensityGiveTheAreaFacingTheLight) {
  SkyOpening shifted = window();
  shifted.centre_world_m += Vec3(0.5, 1, 0.2);  // partly behind the first
  const SkyOpenings openings({window(), shifted}, 0);
  const Vec3 towards = Vec3(0.1, -1, 0.7).normalized();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double sum = 0;
  constexpr int kLines = 100'000;
  for (int i = 0; i < kLines; ++i) {
    Vec3 on_line_m;
    ASSERT_TRUE(openings.sample_line(towards, unit(random), unit(random), on_line_m));
    const double density = openings.line_density_per_m2(towards, on_line_m + 17 * towards);
    ASSERT_GT(density, 0);
    sum += 1 / density;
  }
  // Union of two equal parallelograms. Along the light, the second moves by (0.1, 0.7) per metre that it lies behind.
  const double dx = 0.5 + 0.1, dz = 0.2 + 0.7;
  const double both_m2 = (2 - dx) * (1 - dz);
  EXPECT_NEAR(sum / kLines, (2 + 2 - both_m2) * -towards.y(), 0.01);
  Vec3 none;
  EXPECT_FALSE(openings.sample_line(Vec3::UnitY(), 0.5, 0.5, none));
  EXPECT_EQ(openings.line_density_per_m2(Vec3::UnitY(), {0.3, 0, 1.5}), 0);
  EXPECT_EQ(openings.whole_scene_share(Vec3::UnitY()), 1);
}

TEST(SkyOpenings, AreFoundToCentimetresInRotatedWalls) {
  RoomWithWindows room;
  room.near_window_m = {1.1, 2.3, 1.0, 2.0};
  for (const double turned_rad : {0.0, 0.4, 2.0})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      room.turned_rad = turned_rad;
      const SkyOpenings openings = found(room, seed);
      ASSERT_EQ(openings.openings().size(), 1u) << turned_rad << " " << seed;
      const SkyOpening& one = openings.openings()[0];
      EXPECT_LT((one.centre_world_m - room.world({1.7, 0, 1.5})).norm(), 0.05);
      EXPECT_NEAR(one.outwards_world().dot(room.world(-Vec3::UnitY())), 1, 0.002);
      EXPECT_NEAR(2 * one.half_x_m, 1.2, 0.1);
      EXPECT_NEAR(2 * one.half_y_m, 1.0, 0.1);
      EXPECT_LT(openings.missed_share(), 0.02);
      for (const Receiver& desk : room.desks()) EXPECT_TRUE(one.seen_from_world_m.contains(desk.position_world_m));
      EXPECT_GT(one.surfaces_below, 0.2);
      EXPECT_EQ(one.surfaces_above, 0);
    }
}

TEST(SkyOpenings, TwoWindowsAndASkylightAreFoundSeparately) {
  RoomWithWindows room;
  room.near_window_m = {1, 3, 1, 2};
  room.far_window_m = {0.5, 1.5, 1.2, 2.4};
  room.skylight_m = {2, 3, 2.5, 3.5};
  const SkyOpenings openings = found(room);
  ASSERT_EQ(openings.openings().size(), 3u);
  for (const auto& [middle_m, outwards] : {std::pair{Vec3(2, 0, 1.5), Vec3(-Vec3::UnitY())},
                                           {Vec3(1, 5, 1.8), Vec3::UnitY()},
                                           {Vec3(2.5, 3, 3), Vec3::UnitZ()}}) {
    int as_expected = 0;
    for (const SkyOpening& one : openings.openings())
      as_expected += (one.centre_world_m - middle_m).norm() < 0.06 && one.outwards_world().dot(outwards) > 0.998;
    EXPECT_EQ(as_expected, 1) << middle_m.transpose();
  }
}

TEST(SkyOpenings, AreAbsentWithoutBenefitAndCostNoRayWithoutASky) {
  RoomWithWindows room;
  EXPECT_TRUE(found(room).empty());  // closed
  room.roof = false;
  room.ground = false;
  std::uint64_t rays = 0;
  std::vector<Receiver> outside = {{{-8, -8, 1}, Vec3::UnitZ()}, {{12, 3, 0}, Vec3(1, 0, 1).normalized()}};
  const RayScene scene(room.scene());
  const std::vector<Emitter> sky = {lit_by(make_uniform_sky(1000))};
  EXPECT_TRUE(find_sky_openings(scene, outside, sky, 1, 1, {}, rays).empty());
  EXPECT_LT(rays, 5000u);
  rays = 0;
  const std::vector<Emitter> lamp = {{make_isotropic(1000), {}}};
  EXPECT_TRUE(find_sky_openings(scene, room.desks(), lamp, 1, 1, {}, rays).empty());
  EXPECT_TRUE(find_sky_openings(scene, {}, sky, 1, 1, {}, rays).empty());
  EXPECT_TRUE(find_sky_openings(RayScene{Scene{}}, room.desks(), sky, 1, 1, {}, rays).empty());
  EXPECT_EQ(rays, 0u);
}

TEST(SkyOpenings, ASunHasASingleDirectionButASkyDoesNot) {
  const Vec3 towards = Vec3(0.3, -0.5, 0.6).normalized();
  const auto only = only_direction(*make_sun(towards, 50'000));
  ASSERT_TRUE(only.has_value());
  EXPECT_GT(only->dot(towards), 1 - 1e-4);
  EXPECT_FALSE(only_direction(*make_overcast_sky(1000)));
  EXPECT_FALSE(only_direction(*make_general_sky(15, towards, 1000)));
}

}  // namespace
}  // namespace luxrig
