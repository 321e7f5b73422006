/// direct_shape: the same for any number of threads.

#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "tests/core/transport/direct/direct_shape_fixture.h"

namespace luxrig {
namespace {

using namespace direct_shape_fixture;

TEST(DirectShapeLight, IsTheSameForAnyNumberOfThreadsButNotForOtherSeeds) {
  HalfHidden half(0.1);
  for (int i = 0; i < 20; ++i) half.receivers.push_back({{0.1 * i, 0.05 * i, 0}, Vec3::UnitZ()});
  half.emitters.push_back({nullptr, {}, {}, Vec3::Ones(), std::make_shared<UniformSky>(0.1)});
  EvaluateOptions options;
  options.threads = 1;
  const auto one = direct(half.scene, half.receivers, half.emitters, options);
  for (const int threads : {2, 8}) {
    options.threads = threads;
    const auto other = direct(half.scene, half.receivers, half.emitters, options);
    EXPECT_EQ(one.lux_per_level, other.lux_per_level);
    EXPECT_EQ(one.replicates, other.replicates);
    EXPECT_EQ(one.rays, other.rays);
    EXPECT_EQ(one.relative_error, other.relative_error);
  }
  options.seed = 2;
  EXPECT_NE(direct(half.scene, half.receivers, half.emitters, options).lux_per_level, one.lux_per_level);
}

}  // namespace
}  // namespace luxrig
