/// radiance_cache: accuracy over many samples.
#include <gtest/gtest.h>

#include "tests/core/transport/cube_radiosity.h"
#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/radiance_cache_fixture.h"
#include "tools/bench/cache/radiance_cache.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace radiance_cache_fixture;

TEST(RadianceCache, AnIntegratingSphereReflectsTheSameLightEverywhere) {
  const Scene sphere = make_icosphere(2, 3, 0.7);
  const auto matrix = cached(sphere, receivers_of(spread_over_walls(sphere, 40, Vec3::Zero())),
                             {bulb_at({0.3, -0.2, 0.4})}, quick_sides());
  const double expected_lx = reflected_wall_illuminance_lx(1000, area_m2(sphere), 0.7);
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r)
    EXPECT_NEAR(matrix.lux_per_level(r, 0) - matrix.direct_lux_per_level(r, 0), expected_lx,
                0.03 * matrix.lux_per_level(r, 0));
}

TEST(RadianceCache, FewerCellsShiftAFurnishedRoomOnlyWithinItsError) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  CacheSettings settings;
  settings.voxels = 64;
  settings.gather_rays = settings.light_samples = 512;
  const auto few = RadianceCache::build(room.scene, rays, room.receivers, settings, {});
  settings.only_needed = false;
  const auto all = RadianceCache::build(room.scene, rays, room.receivers, settings, {});
  ASSERT_TRUE(few && all);
  EXPECT_LT(few->report().cells, all->report().cells * 2 / 3);
  const auto a = few->evaluate(room.emitters, {}), b = all->evaluate(room.emitters, {});
  ASSERT_TRUE(a && b);
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(a->emitters());
  const Eigen::ArrayXd moved = (a->lux(levels) - b->lux(levels)).array().abs(),
                       error = a->standard_error_lux(levels).array();
  EXPECT_TRUE((moved <= error).all()) << (moved / error).maxCoeff();
}

}  // namespace
}  // namespace luxrig
