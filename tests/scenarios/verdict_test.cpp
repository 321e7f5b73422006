// The show's verdicts on goals and limits, against the truth of the simulated hall.
#include <gtest/gtest.h>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

TEST(ShowVerdicts, AreTrueForPointsWithAndWithoutAMeter) {
  int goals = 0, met = 0, wrongly_met = 0, missed = 0, wrongly_missed = 0, metered_met = 0, covered = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Hall hall = make_hall(seed);
    hall.rig.control.goal_tolerance = seed % 2 == 0 ? 0.1 : 0.15;
    for (const std::size_t edge : {8, 9, 10}) hall.rig.points[edge].goal_tolerance = 0.3;
    // A goal that cannot be reached, with a small weight.
    hall.rig.points[20].goal_lx = 20 * *hall.rig.points[20].goal_lx;
    hall.rig.points[20].weight = 0.01;
    ClosedLoop loop(hall, seeded(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
    loop.run(5);
    const ShowStatus status = loop.status();
    const std::vector<sim::PointTruth> truth = loop.devices.world().points();
    for (std::size_t p = 0; p < status.points.size(); ++p) {
      const PointStatus& point = status.points[p];
      ASSERT_TRUE(point.verdict.has_value());
      const double goal_lx = *point.goal_lx;
      const bool within = std::abs(truth[p].lux / goal_lx - 1) <= hall.rig.goal_tolerance(p);
      ++goals;
      covered += std::abs(truth[p].lux - point.light.lux) <= point.light.half_width_lx;
      met += point.met();
      metered_met += point.met() && point.measured_lx;
      wrongly_met += point.met() && !within;
      missed += point.verdict == Verdict::missed;
      wrongly_missed += point.verdict == Verdict::missed && within;
      EXPECT_EQ(point.met(), point.reason.empty());
    }
    EXPECT_EQ(status.points[20].verdict, Verdict::missed) << status.points[20].reason;
    EXPECT_EQ(status.limits_kept, 4);
  }
  std::printf(
      "%d goals: %d met (%d by a meter), %d of them wrongly; %d missed, %d of them wrongly; %.1f %% of intervals "
      "hold the truth\n",
      goals, met, metered_met, wrongly_met, missed, wrongly_missed, 100.0 * covered / goals);
  EXPECT_GE(metered_met, 30 * 4);
  EXPECT_LE(wrongly_met, met / 40);
  EXPECT_LE(wrongly_missed, missed / 40);
  EXPECT_GE(covered, goals * 95 / 100);
}

TEST(ShowVerdicts, MeetNoGoalWithoutLuxmetersAndLeaveMostUnknown) {
  Hall hall = make_hall(2);
  hall.rig.luxmeters.clear();
  for (Point& point : hall.rig.points) point.max_lx.reset();
  hall.model.meter_lux_per_level.resize(0, 12);
  hall.truth.conservativeResize(36, 12);
  ClosedLoop loop(hall, seeded(2));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  const ShowStatus status = loop.status();
  EXPECT_EQ(status.goals.met, 0);
  EXPECT_EQ(status.goals.unknown + status.goals.missed, 36);
  EXPECT_GT(status.goals.unknown, 30) << status.points[10].reason;
  EXPECT_NE(status.points[10].reason.find("a luxmeter here would settle it"), std::string::npos)
      << status.points[10].reason;
}

TEST(ShowVerdicts, AreEmptyWithoutGoals) {
  Hall hall = make_hall(2);
  for (Point& point : hall.rig.points) point.goal_lx.reset();
  ClosedLoop loop(hall, seeded(2));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  EXPECT_EQ(loop.status().goals.goals(), 0);
  EXPECT_EQ(loop.status().detail.substr(0, 8), "no goals");
}

TEST(ShowVerdicts, ARejectedReadingOverTheLimitLeavesTheLimitUnknown) {
  ClosedLoop loop(make_hall(3), seeded(3));
  loop.hall.rig.safe.on_meter_loss = false;
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  loop.run(2);
  EXPECT_EQ(loop.status().limits_kept, 4);
  loop.corrupt = [](LuxReading& reading) {
    if (reading.luxmeter == 1) reading.lux = 75;
  };
  loop.run(5);
  const ShowStatus status = loop.status();
  EXPECT_EQ(status.points[1].limit, LimitVerdict::unknown) << status.points[1].limit_reason;
  EXPECT_NE(status.points[1].limit_reason.find("75.0 lx"), std::string::npos) << status.points[1].limit_reason;
  EXPECT_FALSE(status.points[1].met());
  EXPECT_EQ(status.limits_kept, 3);
}

TEST(ShowVerdicts, AnUnresponsiveLampLeavesTheLimitsItCouldBreakUnknown) {
  Hall hall = make_hall(4);
  const std::size_t dead = 9;
  std::size_t near = 6;  // the point without a meter that this lamp lights most
  for (std::size_t p = 6; p < hall.rig.points.size(); ++p)
    if (hall.model.point_lux_per_level(static_cast<Eigen::Index>(p), dead) >
        hall.model.point_lux_per_level(static_cast<Eigen::Index>(near), dead))
      near = p;
  hall.rig.points[near].max_lx = 1.2 * *hall.rig.points[near].goal_lx;
  ClosedLoop loop(hall, seeded(4));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
  EXPECT_EQ(loop.status().points[near].limit, LimitVerdict::kept);
  loop.fault("spot-10", sim::FaultKind::silent, true);
  loop.run(3);
  const ShowStatus status = loop.status();
  EXPECT_EQ(status.points[near].limit, LimitVerdict::unknown) << status.points[near].limit_reason;
  EXPECT_NE(status.points[near].limit_reason.find("does not answer"), std::string::npos)
      << status.points[near].limit_reason;
}

TEST(ShowVerdicts, ADeadDimmerThatHoldsShowsItsHeldLevel) {
  ClosedLoop loop(make_hall(4), seeded(4));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  loop.run(2);
  const double held = loop.status().fixtures[9].level;
  ASSERT_GT(held, 0.15);
  loop.fault("spot-10", sim::FaultKind::silent, true);
  loop.run(15);  // by then the safe look is reached
  const FixtureStatus dead = loop.status().fixtures[9];
  EXPECT_NEAR(dead.level, held, 0.005);
  EXPECT_FALSE(dead.level_known);
  EXPECT_NEAR(loop.devices.world().points()[3].lux, loop.status().points[3].light.lux,
              loop.status().points[3].light.half_width_lx);
}

}  // namespace
}  // namespace luxrig::scenarios
