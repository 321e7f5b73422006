/// radiance_cache: the same for any number of threads.
#include <gtest/gtest.h>

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/radiance_cache_fixture.h"
#include "tools/bench/cache/radiance_cache.h"

namespace luxrig {
namespace {

using namespace radiance_cache_fixture;

TEST(RadianceCache, IsTheSameForAnyNumberOfThreads) {
  const auto receivers = receivers_of(cube_wall_grid(2, 4));
  Scene scene = make_cube(2, 0.6);
  scene.materials[0].reflectance_rgb = {0.7, 0.5, 0.2};
  for (const CacheSettings& settings : all_kinds()) {
    EvaluateOptions options;
    options.colour = true;
    options.threads = 1;
    const auto one = cached(scene, receivers, {bulb_at({0.1, 0.2, 0.3})}, settings, options, 1);
    for (const int threads : {2, 8}) {
      options.threads = threads;
      const auto many = cached(scene, receivers, {bulb_at({0.1, 0.2, 0.3})}, settings, options, threads);
      EXPECT_EQ(one.lux_per_level, many.lux_per_level);
      EXPECT_EQ(one.rgb_per_level, many.rgb_per_level);
      EXPECT_EQ(one.replicates, many.replicates);
    }
  }
}

}  // namespace
}  // namespace luxrig
