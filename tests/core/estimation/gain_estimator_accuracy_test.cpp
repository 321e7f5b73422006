/// gain_estimator: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "core/estimation/gain_estimator.h"
#include "tests/core/estimation/gain_estimator_fixture.h"

namespace luxrig {
namespace {

using namespace gain_estimator_fixture;

TEST(GainEstimator, MeetsMeteredGoalsWithinTwoPercentInThreeRoundsWithinLimits) {
  constexpr unsigned kRigs = 500;
  int met = 0, met_or_said = 0, over_metered = 0, over = 0, rejected = 0;
  double most = 0;
  for (unsigned seed = 0; seed < kRigs; ++seed) {
    World world(seed);
    const Outcome outcome = run(world, 3);
    met += outcome.worst_error <= 0.02;
    met_or_said += outcome.worst_error_aimed <= 0.02;
    over_metered += outcome.max_share_metered > 1;
    over += outcome.max_share > 1;
    most = std::max(most, outcome.max_share);
    rejected += outcome.rejected;
  }
  std::printf(
      "of %u rigs: %d with all six metered goals within 2 %%, %d within 2 %% of goal or of the best that limits "
      "allow; "
      "%d over a metered limit, %d over any; most light %.3f of the limit; %d readings rejected\n",
      kRigs, met, met_or_said, over_metered, over, most, rejected);
  // Before meters are read, limits dim some lamps more than others. This costs four of 500 rigs a fourth round.
  EXPECT_GT(met_or_said, 0.98 * kRigs);
  EXPECT_EQ(over_metered, 0);
  EXPECT_EQ(over, 0);
}

}  // namespace
}  // namespace luxrig
