// correction: accuracy over many samples.
#include <gtest/gtest.h>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

TEST(Show, MeetsMeteredGoalsWithinThreePercentAndKeepsLimitsForFiftySeeds) {
  double worst_error = 0, worst_share = 0, longest_s = 0;
  int max_rounds = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    loop.run(1);
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << "seed " << seed << " " << loop.describe();
    const ShowStatus status = loop.status();
    EXPECT_TRUE(status.converged) << "seed " << seed << " " << loop.describe();
    EXPECT_TRUE(status.alarms.empty()) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(status.round, loop.hall.rig.control.rounds);
    EXPECT_GE(status.round, 1) << "open loop cannot be right, the truth is 10 % off";
    longest_s = std::max(longest_s, loop.seconds() - 1);
    max_rounds = std::max(max_rounds, status.round);
    loop.run(5);
    EXPECT_LE(loop.worst_measured_error(), 0.03) << "seed " << seed << " " << loop.describe();
    // The true error can be larger by the meter's own error.
    EXPECT_LE(loop.worst_true_error(), 0.03 + 0.04) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    EXPECT_TRUE(loop.devices.world().violations().empty()) << "seed " << seed;
    EXPECT_LE(loop.largest_step, kLargestStep) << "seed " << seed;
    worst_error = std::max(worst_error, loop.worst_measured_error());
    worst_share = std::max(worst_share, loop.worst_limit_share());
  }
  std::printf("50 seeds: worst measured error %.2f %%, most lux over limit %.3f, longest %.1f s, most rounds %d\n",
              100 * worst_error, worst_share, longest_s, max_rounds);
}

TEST(Show, ApproachesAGoalAtItsLimitWithinTheMetersTolerance) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ClosedLoop loop(make_hall(seed, {.work_goal_lx = 50}), seeded(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(20);
    const ShowStatus status = loop.status();
    EXPECT_TRUE(status.converged) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    for (std::size_t work = 0; work < kWorks; ++work) {
      // The aim is 50 lx, 48 lx are reached, and the meter may be 4 % wrong. 10 % allow that, 5 % would not.
      EXPECT_NE(status.points[work].verdict, Verdict::missed) << status.points[work].reason;
      EXPECT_NE(status.points[work].why.find("limit"), std::string::npos) << status.points[work].why;
      // With a limit of 50 lx and a meter that may be 4 % wrong, it may show at most 48 lx. A shortfall of 2 %
      // (control.tolerance) is not worth another round, and up to 3 % stay free for noise and for a dimmer's gain at
      // the next levels.
      EXPECT_GE(*status.points[work].measured_lx, 0.95 * 48) << "seed " << seed << " " << loop.describe();
      EXPECT_LE(*status.points[work].measured_lx, 1.01 * 48) << "seed " << seed << " " << loop.describe();
    }
  }
}

TEST(Show, NeverExceedsAnUnmeteredLimit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Hall hall = make_hall(seed);
    for (std::size_t p = 20; p < 24; ++p) hall.rig.points[p].max_lx = 0.9 * *hall.rig.points[p].goal_lx;
    ClosedLoop loop(hall, seeded(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
    loop.run(15);
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    EXPECT_TRUE(loop.devices.world().violations().empty());
  }
}

}  // namespace
}  // namespace luxrig::scenarios
