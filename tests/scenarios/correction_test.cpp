// Whole shows without a fault: light, measure, correct, hold.
#include <gtest/gtest.h>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

TEST(Show, CorrectsForAgeingLamps) {
  ClosedLoop loop(make_hall(3), seeded(3));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  const int rounds = loop.status().round;
  // Every meter slowly shows less, as if all lamps lost 6 % in ten minutes: years of ageing, faster than in reality.
  const double begin_s = loop.seconds();
  loop.corrupt = [&](LuxReading& reading) {
    reading.lux *= 1 - 0.06 * std::min(1.0, (loop.seconds() - begin_s) / 600);
  };
  loop.run(660);
  EXPECT_GT(loop.status().round, rounds);
  // 6 % are three tolerances, and each of the six meters may cross each tolerance at a different time.
  EXPECT_LE(loop.status().round, rounds + 3 * 6) << loop.describe();
  EXPECT_TRUE(loop.run_until(Phase::holding, 10)) << loop.describe();
  EXPECT_LE(loop.worst_measured_error(), 0.03) << loop.describe();
  EXPECT_LE(loop.largest_step, kLargestStep);
}

TEST(Show, LeavesLevelsAloneWhileNothingDrifts) {
  ClosedLoop loop(make_hall(4), seeded(4));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(2);
  const std::uint64_t revision = loop.show.program().revision;
  loop.run(60);
  EXPECT_EQ(loop.show.program().revision, revision) << loop.describe();
}

TEST(Show, ConvergesWithinLimitsWhenReappliedDuringAnyPhase) {
  for (const double after_s : {0.5, 1.9, 2.2, 3.0, 3.7, 4.5, 7.0, 12.0}) {
    ClosedLoop loop(make_hall(5), seeded(5));
    loop.apply();
    loop.run(after_s);
    loop.show.apply(loop.now, std::vector<double>(12, 0.05));
    loop.run(0.7);
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << after_s << loop.describe();
    EXPECT_TRUE(loop.status().converged) << after_s << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << after_s;
    EXPECT_LE(loop.largest_step, kLargestStep) << after_s;
  }
}

TEST(Show, SendsTheSameBytesForTheSameSeed) {
  std::string logs[2];
  for (std::string& log : logs) {
    ClosedLoop loop(make_hall(6), seeded(6));
    loop.keep_log = true;
    loop.apply();
    loop.run(6);
    loop.fault("meter-2", sim::FaultKind::lying, true, 10);
    loop.run(6);
    log = loop.log;
  }
  EXPECT_GT(logs[0].size(), 10000u);
  EXPECT_EQ(logs[0], logs[1]);
}

}  // namespace
}  // namespace luxrig::scenarios
