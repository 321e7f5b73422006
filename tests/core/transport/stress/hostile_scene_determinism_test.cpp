/// hostile_scene: the same for any number of threads.

#include <gtest/gtest.h>

#include "tests/core/transport/stress/hostile_scene.h"
#include "tests/core/transport/stress/hostile_scene_fixture.h"

namespace luxrig {
namespace {

using namespace hostile_scene_fixture;

TEST(HostileScenes, GiveTheSameBytesForOneTwoAndEightThreads) {
  for (std::uint64_t seed = 50'000; seed < 50'040; ++seed) {
    const HostileScene made = HostileScenes(seed).next();
    const RayScene rays(made.scene);
    for (const Entry& entry : kEvaluators) {
      const auto one = entry.make(rays)->evaluate(made.receivers, made.emitters, few_rays(made, seed, 1));
      for (const int threads : {2, 8}) {
        const auto many = entry.make(rays)->evaluate(made.receivers, made.emitters, few_rays(made, seed, threads));
        ASSERT_EQ(one.has_value(), many.has_value());
        if (!one) continue;
        EXPECT_EQ(one->lux_per_level, many->lux_per_level) << entry.name << ", seed " << seed;
        EXPECT_EQ(one->direct_lux_per_level, many->direct_lux_per_level);
        EXPECT_EQ(one->rays, many->rays);
        ASSERT_EQ(one->replicates.size(), many->replicates.size());
        for (std::size_t k = 0; k < one->replicates.size(); ++k) EXPECT_EQ(one->replicates[k], many->replicates[k]);
      }
    }
  }
}

}  // namespace
}  // namespace luxrig
