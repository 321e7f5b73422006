// Each fault, and what must hold: no limit exceeded, no jump, an alarm within two seconds, recovery without help.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

struct FaultCase {
  const char* name;
  const char* device;
  sim::FaultKind kind;
  std::optional<double> value;
  bool needs_change;  ///< only shows once the light changes
};

const FaultCase kFaults[] = {
    {"AMeterThatFallsSilent", "meter-1", sim::FaultKind::silent, {}, false},
    {"AMeterThatAnswersGarbage", "meter-2", sim::FaultKind::garbled, {}, false},
    {"AMeterThatRefuses", "meter-5", sim::FaultKind::exception, {}, false},
    {"AMeterThatShowsTenTimesTooMuch", "meter-3", sim::FaultKind::lying, 10.0, false},
    {"AMeterThatShowsATenth", "meter-4", sim::FaultKind::lying, 0.1, false},
    {"AMeterThatIsStuck", "meter-1", sim::FaultKind::stuck, {}, true},
    {"TheBusOfTheMeters", "meters", sim::FaultKind::dead, {}, false},
    {"TheBusOfTheDimmers", "dimmers", sim::FaultKind::dead, {}, false},
    {"ADimmerThatFallsSilent", "spot-10", sim::FaultKind::silent, {}, false},
    {"TheBusOfTheTrack", "track", sim::FaultKind::dead, {}, false},
};

class Fault : public testing::TestWithParam<FaultCase> {};

class FaultInAFade : public Fault {};
class FaultOfAMeter : public Fault {};

std::vector<FaultCase> faults_where(const std::function<bool(const FaultCase&)>& wanted) {
  std::vector<FaultCase> some;
  std::copy_if(std::begin(kFaults), std::end(kFaults), std::back_inserter(some), wanted);
  return some;
}
std::string name_of_case(const testing::TestParamInfo<FaultCase>& instance) { return instance.param.name; }

INSTANTIATE_TEST_SUITE_P(Each, Fault, testing::ValuesIn(kFaults), name_of_case);
// A lie or a stuck value only shows under steady light.
INSTANTIATE_TEST_SUITE_P(Each, FaultInAFade, testing::ValuesIn(faults_where([](const FaultCase& fault) {
                           return !fault.needs_change && fault.kind != sim::FaultKind::lying;
                         })),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Each, FaultOfAMeter, testing::ValuesIn(faults_where([](const FaultCase& fault) {
                           return std::string(fault.device).rfind("meter", 0) == 0;
                         })),
                         name_of_case);

/// A rig with the rule: on any failure, all light goes to the safe look.
Hall all_safe(Hall hall) {
  hall.rig.safe.scope = SafeScope::all;
  hall.rig.safe.on_meter_loss = true;
  return hall;
}

bool alarmed(const ClosedLoop& loop, const std::string& device) {
  for (const Alarm& alarm : loop.status().alarms) {
    if (alarm.device == device && alarm.severe && alarm.text.find(device) != std::string::npos) return true;
  }
  return false;
}

TEST_P(Fault, NeverChangesTheLightBySurpriseAndRecovers) {
  const FaultCase& fault = GetParam();
  ClosedLoop loop(all_safe(make_hall(11)), seeded(11));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  loop.run(3);
  const std::vector<double> held = loop.levels();
  loop.fault(fault.device, fault.kind, true, fault.value);
  if (fault.needs_change) {
    loop.run(1);
    std::vector<double> dimmer = loop.hall.plan;
    for (double& level : dimmer) level *= 0.6;
    loop.show.apply(loop.now, dimmer);
    ASSERT_TRUE(loop.run_until(Phase::measuring, 5));
  }
  EXPECT_TRUE(loop.run_until([&] { return alarmed(loop, fault.device); }, 2.0)) << loop.describe();
  // The alarm comes at once. One late answer moves nothing, so the show waits a little before it acts.
  EXPECT_TRUE(loop.run_until(Phase::frozen, 1.3)) << loop.describe();
  const std::vector<double> frozen = loop.levels();
  EXPECT_TRUE(fault.needs_change || frozen == held) << "not held to the last bit";
  loop.run(loop.hall.rig.safe.hold_s - 0.3);
  EXPECT_EQ(loop.levels(), frozen);
  ASSERT_TRUE(loop.run_until(Phase::safe, 3 + loop.hall.rig.safe.fade_s)) << loop.describe();
  for (const double level : loop.levels()) EXPECT_LE(level, loop.hall.rig.safe.level);
  loop.run(5);
  EXPECT_EQ(loop.phase(), Phase::safe);
  EXPECT_TRUE(alarmed(loop, fault.device)) << loop.describe();

  loop.fault(fault.device, fault.kind, false);
  EXPECT_TRUE(loop.run_until(Phase::fading, 5)) << loop.describe();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  EXPECT_TRUE(loop.status().converged) << loop.describe();
  EXPECT_TRUE(loop.status().alarms.empty()) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1) << loop.describe();
  EXPECT_LE(loop.largest_step, kLargestStep);
}

TEST_P(Fault, FromTheStartNeverDrivesTheLightAboveALimit) {
  const FaultCase& fault = GetParam();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    ClosedLoop loop(all_safe(make_hall(seed)), seeded(seed));
    loop.fault(fault.device, fault.kind, true, fault.value);
    loop.run(0.5);
    loop.apply();
    loop.run(15);
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.largest_step, kLargestStep);
    loop.fault(fault.device, fault.kind, false);
    EXPECT_TRUE(loop.run_until([&] { return loop.status().converged; }, 30)) << "seed " << seed << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
  }
}

TEST_P(FaultInAFade, HoldsTheCurrentLightAndResumesAfterRecovery) {
  const FaultCase& fault = GetParam();
  ClosedLoop loop(all_safe(make_hall(12)), seeded(12));
  loop.hall.rig.control.fade_s = 6;
  ClosedLoop slow(loop.hall, seeded(12));
  slow.run(1);
  slow.apply();
  slow.run(2);
  slow.fault(fault.device, fault.kind, true, fault.value);
  ASSERT_TRUE(slow.run_until(Phase::frozen, 2)) << slow.describe();
  const std::vector<double> frozen = slow.levels();
  for (std::size_t i = 0; i < frozen.size(); ++i) {
    EXPECT_GT(frozen[i], 0);
    EXPECT_LT(frozen[i], slow.hall.plan[i]);
  }
  slow.run(1);
  EXPECT_EQ(slow.levels(), frozen);
  slow.fault(fault.device, fault.kind, false);
  EXPECT_TRUE(slow.run_until(Phase::fading, 2)) << slow.describe();
  ASSERT_TRUE(slow.run_until(Phase::holding, 30)) << slow.describe();
  EXPECT_TRUE(slow.status().converged) << slow.describe();
  EXPECT_LE(slow.largest_step, kLargestStep);
  EXPECT_LE(slow.worst_limit_share(), 1);
}

TEST_P(FaultOfAMeter, OnlyStopsTheCorrectionWhenConfiguredSo) {
  const FaultCase& fault = GetParam();
  Hall hall = make_hall(13);
  hall.rig.safe.on_meter_loss = false;
  ClosedLoop loop(hall, seeded(13));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(3);
  loop.fault(fault.device, fault.kind, true, fault.value);
  if (fault.needs_change) loop.show.apply(loop.now, std::vector<double>(12, 0.1));
  loop.run(15);
  EXPECT_EQ(loop.phase(), Phase::holding) << loop.describe();
  EXPECT_TRUE(alarmed(loop, fault.device)) << loop.describe();
  EXPECT_FALSE(loop.status().converged);
  loop.run(20);
  EXPECT_EQ(loop.phase(), Phase::holding) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1);
  loop.fault(fault.device, fault.kind, false);
  EXPECT_TRUE(loop.run_until([&] { return loop.status().converged; }, 30)) << loop.describe();
  EXPECT_TRUE(loop.status().alarms.empty()) << loop.describe();
}

TEST(Unseen, LossOfAOneWayBusIsDetectedByTheMeters) {
  ClosedLoop loop(all_safe(make_hall(20)), seeded(20));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(3);
  loop.fault("track", sim::FaultKind::silent, true);  // DMX goes one way: no driver can know
  std::vector<double> dimmer = loop.hall.plan;
  for (double& level : dimmer) level *= 0.6;
  loop.show.apply(loop.now, dimmer);
  ASSERT_TRUE(loop.run_until(Phase::frozen, 10)) << loop.describe();
  ASSERT_FALSE(loop.status().alarms.empty());
  EXPECT_NE(loop.status().alarms[0].text.find("cannot be believed"), std::string::npos) << loop.describe();
  loop.run(1);
  loop.fault("track", sim::FaultKind::silent, false);
  ASSERT_TRUE(loop.run_until([&] { return loop.status().converged; }, 40)) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1);
}

TEST(ACoveredMeter, IsNotTrustedUntilAPersonReappliesThePlan) {
  ClosedLoop loop(all_safe(make_hall(21)), seeded(21));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(3);
  loop.fault("meter-6", sim::FaultKind::lying, true, 0.7);  // allowed by the model, but not by earlier readings
  ASSERT_TRUE(loop.run_until(Phase::safe, 20)) << loop.describe();
  loop.run(60);
  EXPECT_EQ(loop.phase(), Phase::safe) << loop.describe();
  loop.apply();
  EXPECT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  EXPECT_TRUE(loop.status().alarms.empty()) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1);
}

// "A meter that is stuck, dead or wrong cannot drive the light up".
TEST(WhatMustAlwaysHold5, AMeterThatLiesFromTheFirstReadingCannotDriveTheLightUp) {
  for (const double factor : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.5, 10.0}) {
    for (const char* meter : {"meter-1", "meter-5"}) {
      ClosedLoop loop(make_hall(14), seeded(14));
      loop.fault(meter, sim::FaultKind::lying, true, factor);
      loop.apply();
      loop.run(40);
      // Correction can compensate the combined error of lamps (gain_min) and model (open_loop_margin), but no more.
      const double most = 1 / (loop.hall.rig.control.gain_min * (1 - loop.hall.rig.limits.open_loop_margin));
      const Eigen::VectorXd level = Eigen::Map<const Eigen::VectorXd>(loop.levels().data(), 12);
      const Eigen::VectorXd lux = loop.hall.model.point_lux_per_level * level;
      for (Eigen::Index p = 0; p < 6; ++p) {
        EXPECT_LE(lux[p], most * *loop.hall.rig.points[static_cast<std::size_t>(p)].goal_lx)
            << meter << " × " << factor;
      }
      EXPECT_FALSE((factor < 0.35 || factor > 2) && loop.status().converged) << meter << " × " << factor;
    }
  }
}

TEST(WhatMustAlwaysHold5, InvalidReadingsOfAllMetersCountAsTheirLoss) {
  for (const double garbage : {std::nan(""), std::numeric_limits<double>::infinity(), -5.0}) {
    ClosedLoop loop(all_safe(make_hall(15)), seeded(15));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 30));
    const std::vector<double> held = loop.levels();
    loop.corrupt = [&](LuxReading& reading) { reading.lux = garbage; };
    ASSERT_TRUE(loop.run_until(Phase::frozen, 2)) << loop.describe();
    EXPECT_EQ(loop.levels(), held);
    loop.run(0.5);
    EXPECT_EQ(loop.status().alarms.size(), 6u);
    EXPECT_NE(loop.status().alarms[0].text.find("no usable number"), std::string::npos) << loop.describe();
    loop.corrupt = nullptr;
    ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
    EXPECT_TRUE(loop.status().converged);
  }
}

// "Loss of a device, a bus, a meter … never changes the light by surprise" (2), everything at once.
TEST(WhatMustAlwaysHold2, LosingEverythingDuringAFadeHoldsThenGoesSafeThenRecovers) {
  ClosedLoop loop(all_safe(make_hall(16)), seeded(16));
  loop.run(1);
  loop.apply();
  loop.run(1);
  for (const char* bus : {"track", "dimmers", "meters"}) loop.fault(bus, sim::FaultKind::dead, true);
  ASSERT_TRUE(loop.run_until(Phase::frozen, 2));
  loop.run(1);
  EXPECT_EQ(loop.status().alarms.size(), 3u) << "one for each bus\n" << loop.describe();
  ASSERT_TRUE(loop.run_until(Phase::safe, 10));
  for (const char* bus : {"track", "dimmers", "meters"}) loop.fault(bus, sim::FaultKind::dead, false);
  ASSERT_TRUE(loop.run_until(Phase::holding, 30)) << loop.describe();
  EXPECT_TRUE(loop.status().converged) << loop.describe();
  EXPECT_LE(loop.largest_step, kLargestStep);
  EXPECT_LE(loop.worst_limit_share(), 1);
}

TEST(WhatMustAlwaysHold2, AFlappingDeviceNeverMakesTheLightPump) {
  ClosedLoop loop(all_safe(make_hall(17)), seeded(17));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  for (int i = 0; i < 20; ++i) {
    loop.fault("dimmers", sim::FaultKind::dead, i % 2 == 0);
    loop.run(0.3);
  }
  EXPECT_LE(loop.largest_step, kLargestStep);
  ASSERT_TRUE(loop.run_until([&] { return loop.status().converged; }, 30)) << loop.describe();
  EXPECT_LE(loop.worst_limit_share(), 1);
}

// "No output, at any instant of a fade, exceeds a fixture's limits, a conservation limit in the model, or a measured
// conservation limit" (1): one minute of random commands and accidents.
TEST(WhatMustAlwaysHold1, NoInstantOfAnyFadeExceedsALimitUnderRandomFailures) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Hall hall = make_hall(seed);
    hall.rig.fixtures[6].max_level = 0.3;
    ClosedLoop loop(hall, seeded(seed));
    std::mt19937_64 random(seed);
    const char* devices[] = {"meter-1", "meter-3", "meter-6", "meters", "dimmers", "track", "spot-11"};
    while (loop.seconds() < 60) {
      const std::vector<double> wanted = random_levels(random);
      const char* device = devices[random() % std::size(devices)];
      const sim::FaultKind kind = random() % 2 ? sim::FaultKind::dead : sim::FaultKind::silent;
      switch (random() % 8) {
        case 0:
        case 1:
          loop.show.apply(loop.now, wanted);
          break;
        case 2:
        case 3:
          loop.apply();
          break;
        case 4:
          loop.show.blackout(loop.now, random() % 4 == 0);
          break;
        case 5:
          loop.fault(device, kind, true);
          break;
        case 6:
          loop.devices.faults().clear();
          break;
        default:
          if (random() % 4 == 0) loop.show.go_safe(loop.now);
      }
      loop.run(4 * random_share(random));
      EXPECT_LE(loop.levels()[6], 0.3);
    }
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
    EXPECT_TRUE(loop.devices.world().violations().empty());
    loop.devices.faults().clear();
    loop.show.blackout(loop.now, false);
    for (double& level : loop.hall.plan) level = std::min(level, 0.3);
    loop.apply();
    EXPECT_TRUE(loop.run_until(Phase::holding, 40)) << "seed " << seed << " " << loop.describe();
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed << " " << loop.describe();
  }
}

TEST(Blackout, IsDarkAtTheNextOutputInEveryPhaseAndFadesBack) {
  // Seconds into the show: fade, settling, measuring, correcting, holding. With a fault: frozen, safe fade, safe.
  struct Moment {
    double at_s;
    bool fault;
  };
  for (const Moment moment :
       {Moment{1, false}, {2.2, false}, {2.8, false}, {3.8, false}, {15, false}, {17, true}, {21, true}, {26, true}}) {
    ClosedLoop loop(all_safe(make_hall(18)), seeded(18));
    loop.apply();
    loop.run(std::min(moment.at_s, 15.0));
    if (moment.fault) {
      loop.fault("dimmers", sim::FaultKind::dead, true);
      loop.run(moment.at_s - 15);
    }
    loop.show.blackout(loop.now, true);
    for (const double level : loop.levels()) EXPECT_EQ(level, 0);
    loop.run(4);
    EXPECT_TRUE(loop.status().blackout);
    EXPECT_FALSE(loop.status().converged);
    for (const double level : loop.levels()) EXPECT_EQ(level, 0);
    loop.fault("dimmers", sim::FaultKind::dead, false);
    loop.run(2);
    for (const double level : loop.levels()) EXPECT_EQ(level, 0) << "a mended bus does not lift a blackout";
    const double before = loop.largest_step;
    loop.show.blackout(loop.now, false);
    loop.run(0.02);
    for (const double level : loop.levels()) EXPECT_LT(level, kLargestStep) << "fades up, does not jump";
    ASSERT_TRUE(loop.run_until([&] { return loop.status().converged; }, 30)) << moment.at_s << loop.describe();
    EXPECT_LE(loop.largest_step, std::max(before, kLargestStep)) << moment.at_s;
    EXPECT_LE(loop.worst_limit_share(), 1);
  }
}

TEST(Daylight, ThatAddsToALimitedPointMakesTheShowDimAndReportIt) {
  ClosedLoop loop(make_hall(19), seeded(19));
  loop.apply();
  ASSERT_TRUE(loop.run_until(Phase::holding, 30));
  loop.run(3);
  const double before = loop.levels()[0];
  loop.corrupt = [](LuxReading& reading) {
    if (reading.luxmeter == 0) reading.lux += 6;
  };
  EXPECT_TRUE(loop.run_until(
      [&] {
        for (const Alarm& alarm : loop.status().alarms) {
          if (alarm.text.find("work-1") != std::string::npos) return true;
        }
        return false;
      },
      3))
      << loop.describe();
  loop.run(15);
  EXPECT_LT(loop.levels()[0], before);
  EXPECT_LE(*loop.status().points[0].measured_lx, 50 * 0.97) << loop.describe();
}

}  // namespace
}  // namespace luxrig::scenarios
