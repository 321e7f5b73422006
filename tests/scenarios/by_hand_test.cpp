// Levels that a person sets by hand in a whole simulated hall: they stay, the rest is corrected, and no limit breaks.
#include <gtest/gtest.h>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

TEST(ByHandInTheHall, KeepsALevelMeetsOtherGoalsAndHoldsLimitsForTenSeeds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    if (seed % 2 == 0) loop.solve_late(1.5);
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    const std::vector<double> before = loop.levels();
    const std::size_t held = seed % kWorks;
    ASSERT_TRUE(loop.show.hold(loop.now, std::vector{ByHand{ByHand::What::level, held, 0.05, loop.now}}));
    loop.run(5);
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(60);
    EXPECT_NEAR(loop.levels()[held], 0.05, 1e-9) << "seed " << seed << " " << loop.describe();
    loop.show.release(loop.now, std::vector<std::size_t>{held}, {});
    loop.run(5);
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(5);
    EXPECT_LE(loop.worst_measured_error(), 0.03) << "seed " << seed << " " << loop.describe();
    EXPECT_NEAR(loop.levels()[held], before[held], 0.15 * before[held] + 0.02) << "seed " << seed;
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.largest_step, kLargestStep) << "seed " << seed;
  }
}

TEST(ByHandInTheHall, FullLevelsByHandGiveAsMuchAsALimitAllows) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    if (seed % 2 == 0) loop.solve_late(1.5);
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    std::vector<ByHand> all;
    for (std::size_t f = 0; f < loop.hall.rig.fixtures.size(); ++f)
      all.push_back({ByHand::What::level, f, 1, loop.now});
    ASSERT_TRUE(loop.show.hold(loop.now, all));
    loop.run(40);
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    const ShowStatus status = loop.status();
    bool any_says_so = false;
    for (const ByHand& one : status.by_hand) any_says_so = any_says_so || one.why.find("limit") != std::string::npos;
    EXPECT_TRUE(any_says_so) << loop.describe();
  }
}

TEST(ByHandInTheHall, AGoalSetByHandIsMetAndItsReleaseRestoresTheOriginal) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    if (seed % 2 == 0) loop.solve_late(1.5);
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    const std::size_t point = *loop.hall.rig.luxmeters[0].point;
    const double goal_lx = 0.6 * *loop.hall.rig.points[point].goal_lx;
    ASSERT_TRUE(loop.show.hold(loop.now, std::vector{ByHand{ByHand::What::goal, point, goal_lx, loop.now}}));
    loop.run(5);
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(15);
    EXPECT_NEAR(*loop.status().points[point].measured_lx, goal_lx, 0.03 * goal_lx)
        << "seed " << seed << loop.describe();
    loop.show.release(loop.now, {}, std::vector<std::size_t>{point});
    loop.run(5);
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(15);
    EXPECT_LE(loop.worst_measured_error(), 0.03) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed;
  }
}

TEST(ByHandInTheHall, APlanFadesAsLongAsItsSenderWants) {
  ClosedLoop loop(make_hall(3), seeded(3));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  Look look;
  for (const Fixture& fixture : loop.hall.rig.fixtures) look.joints.push_back(fixture.joints);
  for (const Point& point : loop.hall.rig.points) look.goal_lx.push_back(point.goal_lx);
  look.levels = loop.hall.plan;
  for (double& level : look.levels) level *= 0.5;
  const double seconds = loop.hall.rig.control.fade_s + 4;
  loop.show.apply(loop.now, look, loop.hall.model, seconds);
  loop.run(seconds - 0.5);
  EXPECT_EQ(loop.status().phase, Phase::fading) << loop.describe();
  loop.run(1);
  EXPECT_NE(loop.status().phase, Phase::fading) << loop.describe();
}

// A rig file read again: the light goes on, limits hold, and the new goals apply.
TEST(ByHandInTheHall, AReplacedRigFadesToItsNewGoalsWithinItsNewLimits) {
  for (const bool same_light : {true, false}) {
    ClosedLoop loop(make_hall(3), seeded(3));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    const std::vector<double> before = loop.levels();
    Rig rig = loop.hall.rig;
    for (Point& point : rig.points)
      if (point.goal_lx) *point.goal_lx *= 0.8;
    loop.show.exchange_rig(loop.now, rig, loop.hall.model, same_light);
    EXPECT_EQ(loop.levels(), before) << "to the last bit";
    Look look;
    for (const Fixture& fixture : rig.fixtures) look.joints.push_back(fixture.joints);
    for (const Point& point : rig.points) look.goal_lx.push_back(point.goal_lx);
    look.levels = loop.hall.plan;
    for (double& level : look.levels) level *= 0.8;
    loop.show.apply(loop.now, look, loop.hall.model);
    EXPECT_EQ(loop.levels(), before) << "a fade begins where the light was";
    loop.run(5);
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    loop.run(10);
    for (const Luxmeter& meter : rig.luxmeters) {
      const double goal_lx = *rig.points[*meter.point].goal_lx;
      EXPECT_NEAR(*loop.status().points[*meter.point].measured_lx, goal_lx, 0.03 * goal_lx) << loop.describe();
    }
    EXPECT_LE(loop.worst_limit_share(), 1) << loop.describe();
    EXPECT_LE(loop.largest_step, kLargestStep) << same_light;
  }
}

}  // namespace
}  // namespace luxrig::scenarios
