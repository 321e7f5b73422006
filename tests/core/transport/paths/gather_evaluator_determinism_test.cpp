/// gather_evaluator: the same for any number of threads.

#include <gtest/gtest.h>

#include "tests/core/transport/paths/gather_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace gather_evaluator_fixture;

TEST(GatherEvaluator, IsTheSameForAnyNumberOfThreads) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  EvaluateOptions options = within(0.1);
  options.threads = 1;
  const auto one = evaluated(make_gather_evaluator(rays), room.receivers, room.emitters, options);
  for (const int threads : {2, 8}) {
    options.threads = threads;
    const auto other = evaluated(make_gather_evaluator(rays), room.receivers, room.emitters, options);
    EXPECT_EQ(other.lux_per_level, one.lux_per_level) << threads;
    EXPECT_EQ(other.replicates, one.replicates) << threads;
  }
}

}  // namespace
}  // namespace luxrig
