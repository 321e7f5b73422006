/// path_evaluator: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "tests/core/transport/paths/path_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace path_evaluator_fixture;

TEST(PathEvaluator, IsTheSameForAnyNumberOfThreadsAndRepetition) {
  const RayScene rays(make_cube(2, 0.5));
  const auto receivers = receivers_on(make_cube(2, 0.5), 5);
  const std::vector<Emitter> emitters = {bulb_at(300, {-0.2, 0.1, 0.2}), bulb_at(200, {0.2, 0.4, 0.5})};
  auto options = within(0.05);
  options.threads = 1;
  const auto one = path(rays, receivers, emitters, options);
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    const auto other = path(rays, receivers, emitters, options);
    EXPECT_EQ(other.lux_per_level, one.lux_per_level) << threads;
    EXPECT_EQ(other.replicates, one.replicates) << threads;
    EXPECT_EQ(other.rays, one.rays) << threads;
  }
  options.seed = 2;
  EXPECT_NE(path(rays, receivers, emitters, options).lux_per_level, one.lux_per_level);
}

}  // namespace
}  // namespace luxrig
