// Parts that share nothing with the failed one go on.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

bool only_alarm_is_of(const ClosedLoop& loop, const std::string& device) {
  const std::vector<Alarm> alarms = loop.status().alarms;
  return alarms.size() == 1 && alarms[0].device == device;
}

/// Works have meters, which watch their limits.
TEST(FailureDomain, ADeadDimmerBusSendsOnlyItsLampsToTheSafeLook) {
  ClosedLoop loop(make_hall(31), seeded(31));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  loop.run(3);
  const std::vector<double> before = loop.levels();
  loop.fault("dimmers", sim::FaultKind::dead, true);
  ASSERT_TRUE(loop.run_until([&] { return !loop.status().alarms.empty(); }, 2));
  loop.run(loop.hall.rig.safe.hold_s - 1);
  EXPECT_EQ(loop.levels(), before) << "held first";
  loop.run(10);
  const std::vector<double> after = loop.levels();
  for (std::size_t f = 0; f < 8; ++f) EXPECT_EQ(after[f], before[f]) << f;
  for (std::size_t f = 8; f < 12; ++f) {
    EXPECT_EQ(after[f], std::min(before[f], loop.hall.rig.safe.level)) << f;
    EXPECT_FALSE(loop.status().fixtures[f].level_known);
  }
  EXPECT_EQ(loop.phase(), Phase::holding) << loop.describe();
  EXPECT_TRUE(only_alarm_is_of(loop, "dimmers")) << loop.describe();

  loop.fault("dimmers", sim::FaultKind::dead, false);
  ASSERT_TRUE(loop.run_until([&] { return loop.status().converged; }, 30)) << loop.describe();
  EXPECT_TRUE(loop.status().alarms.empty()) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1) << loop.describe();
  EXPECT_LE(loop.largest_step, kLargestStep);
}

TEST(FailureDomain, OneDeadDimmerRaisesOneAlarmAndMovesNoOtherLamp) {
  ClosedLoop loop(make_hall(32), seeded(32));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  loop.run(3);
  const std::vector<double> before = loop.levels();
  loop.fault("spot-10", sim::FaultKind::silent, true);
  loop.run(20);
  const std::vector<double> after = loop.levels();
  for (std::size_t f = 0; f < 12; ++f) {
    if (f != 9) {
      EXPECT_NEAR(after[f], before[f], 0.02 * before[f]) << f;
    }
  }
  EXPECT_TRUE(only_alarm_is_of(loop, "spot-10")) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1) << loop.describe();
}

TEST(FailureDomain, TheRestFadesToAPlanWhileABusIsDead) {
  ClosedLoop loop(make_hall(33), seeded(33));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.fault("dimmers", sim::FaultKind::dead, true);
  loop.run(15);
  std::vector<double> dimmer = loop.hall.plan;
  for (double& level : dimmer) level *= 0.5;
  loop.show.apply(loop.now, dimmer);
  loop.run(5);
  for (std::size_t f = 0; f < 8; ++f) EXPECT_NEAR(loop.levels()[f], dimmer[f], 0.2 * dimmer[f]) << f;
  EXPECT_LE(loop.largest_step, kLargestStep);
}

TEST(FailureDomain, ALampThatMayBeAtFullCountsAsFullForUnmeteredLimits) {
  Hall hall = make_hall(34);
  const Eigen::VectorXd plan = Eigen::Map<const Eigen::VectorXd>(hall.plan.data(), 12);
  // A place without a meter. The dimmers' lamps give it much light at full, but not all of its planned light.
  Eigen::Index place = -1;
  for (Eigen::Index p = 6; p < 36 && place < 0; ++p) {
    const Eigen::RowVectorXd row = hall.model.point_lux_per_level.row(p);
    const double share = row.segment(8, 4).sum() / row.dot(plan);
    if (share > 0.5 && share < 0.9) place = p;
  }
  ASSERT_GE(place, 0);
  const Eigen::RowVectorXd row = hall.model.point_lux_per_level.row(place);
  const double max_lx = 1.54 * row.dot(plan), full_lx = row.segment(8, 4).sum();  // gain_max over 1 - margin is 1.533
  hall.rig.points[static_cast<std::size_t>(place)].max_lx = max_lx;
  ClosedLoop loop(hall, seeded(34));
  const auto others_lx = [&] {
    const std::vector<double> level = loop.levels();
    return row.head(8).dot(Eigen::Map<const Eigen::VectorXd>(level.data(), 8));
  };
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  const double before_lx = others_lx();
  loop.fault("dimmers", sim::FaultKind::dead, true);
  loop.run(3);
  EXPECT_NEAR(others_lx(), before_lx, 0.02 * before_lx) << "not by surprise";
  loop.run(20);
  EXPECT_LT(others_lx(), 0.98 * before_lx) << loop.describe();
  EXPECT_LE(others_lx() + full_lx, max_lx) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1);
  loop.fault("dimmers", sim::FaultKind::dead, false);
  loop.run(15);
  EXPECT_NEAR(others_lx(), before_lx, 0.05 * before_lx) << "what was dimmed for it comes back with it";
}

TEST(FailureDomain, ALostMeterAffectsOnlyWhatDependsOnIt) {
  ClosedLoop loop(make_hall(35), seeded(35));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(3);
  loop.fault("meter-2", sim::FaultKind::silent, true);
  loop.run(20);
  EXPECT_EQ(loop.phase(), Phase::holding) << loop.describe();
  EXPECT_TRUE(only_alarm_is_of(loop, "meter-2")) << loop.describe();
  // The other meters are still read, and their points corrected.
  std::vector<double> brighter = loop.hall.plan;
  for (double& level : brighter) level *= 0.8;
  loop.show.apply(loop.now, brighter);
  loop.run(25);
  for (const std::size_t meter : {2u, 3u, 4u, 5u}) {
    const PointStatus point = loop.status().points[*loop.hall.rig.luxmeters[meter].point];
    ASSERT_TRUE(point.measured_lx.has_value());
    EXPECT_NEAR(*point.measured_lx, *point.goal_lx, 0.04 * *point.goal_lx) << meter << loop.describe();
  }
  EXPECT_LE(loop.worst_limit_share(), 1);
}

TEST(FailureDomain, NoLimitIsExceededUnderRandomRequestsAndFailures) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    std::mt19937_64 random(seed);
    const char* devices[] = {"meter-1", "meter-3", "meter-6", "meters", "dimmers", "track", "spot-11"};
    while (loop.seconds() < 60) {
      const std::vector<double> wanted = random_levels(random);
      const char* device = devices[random() % std::size(devices)];
      // A silent device on a one-way line is not noticed.
      const bool unseen = std::string(device) == "track";
      const sim::FaultKind kind = unseen || random() % 2 ? sim::FaultKind::dead : sim::FaultKind::silent;
      switch (random() % 6) {
        case 0:
          loop.show.apply(loop.now, wanted);
          break;
        case 1:
        case 2:
          loop.apply();
          break;
        case 3:
          loop.devices.faults().clear();
          break;
        default:
          loop.fault(device, kind, true);
      }
      loop.run(4 * random_share(random));
    }
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    loop.devices.faults().clear();
    loop.apply();
    EXPECT_TRUE(loop.run_until(Phase::holding, 60)) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
  }
}

TEST(FailureDomain, ARigSoConfiguredGoesToItsSafeLookAsAWhole) {
  Hall hall = make_hall(36);
  hall.rig.safe.scope = SafeScope::all;
  hall.rig.buses[0].safe_level = 0.05;
  ClosedLoop loop(hall, seeded(36));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.fault("spot-10", sim::FaultKind::silent, true);
  ASSERT_TRUE(loop.run_until(Phase::safe, 20)) << loop.describe();
  for (std::size_t f = 0; f < 12; ++f) EXPECT_EQ(loop.levels()[f], f < 8 ? 0.05 : 0.1) << f;
}

}  // namespace
}  // namespace luxrig::scenarios
