// Meters and lamps that answer late, now and then, or wrongly: nothing moves for one late answer, nobody honest is
// accused, and what can be a lie of all is said.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

/// A rig that says: whatever fails, all light goes to the safe look.
Hall all_to_safe(std::uint64_t seed) {
  Hall hall = make_hall(seed);
  hall.rig.safe.scope = SafeScope::all;
  hall.rig.safe.on_meter_loss = true;
  return hall;
}

TEST(ALateAnswer, ChangesNoLight) {
  // Drivers report half a second of silence at once; buses, a connection that was closed.
  struct Late {
    const char* device;
    sim::FaultKind kind;
    double for_s;
  };
  for (const Late late : {Late{"meter-1", sim::FaultKind::silent, 1.2}, {"spot-10", sim::FaultKind::silent, 0.9},
                          {"meters", sim::FaultKind::dead, 0.4}, {"dimmers", sim::FaultKind::dead, 0.4}}) {
    for (const bool all : {true, false}) {
      for (const double at_s : {1.0, 25.0}) {  // in the fade, and in steady light
        const Hall hall = all ? all_to_safe(41) : make_hall(41);
        ClosedLoop loop(hall, seeded(41)), undisturbed(hall, seeded(41));
        for (ClosedLoop* one : {&loop, &undisturbed}) {
          one->run(0.5);
          one->apply();
          one->run(at_s);
        }
        double most = 0;
        bool reported = false;
        loop.fault(late.device, late.kind, true);
        for (int i = 0; i < 400; ++i) {
          if (i == static_cast<int>(late.for_s / 0.05)) loop.devices.faults().clear();
          loop.run(0.05);
          undisturbed.run(0.05);
          reported = reported || !loop.status().alarms.empty();
          const std::vector<double> one = loop.levels(), other = undisturbed.levels();
          for (std::size_t f = 0; f < one.size(); ++f) most = std::max(most, std::abs(one[f] - other[f]));
        }
        EXPECT_TRUE(reported) << late.device << ": the driver did report it, or this tests nothing";
        EXPECT_LE(most, 0.01) << late.device << (all ? ", all" : "") << ", after " << at_s << " s " << loop.describe();
        EXPECT_LE(loop.worst_limit_share(), 1);
      }
    }
  }
}

TEST(AMeterThatLosesHalfItsAnswers, ChangesTheStateOnceAtMostInTenMinutes) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    ClosedLoop loop(all_to_safe(seed), seeded(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
    loop.fault("meter-2", sim::FaultKind::lost, true, 0.5);
    int changes = 0;
    bool was_safe = false;
    for (int i = 0; i < 6000; ++i) {
      loop.run(0.1);
      const Phase phase = loop.phase();
      const bool safe = phase == Phase::frozen || phase == Phase::safe_fading || phase == Phase::safe;
      changes += safe != was_safe;
      was_safe = safe;
    }
    EXPECT_LE(changes, 1) << "seed " << seed << " " << loop.describe();
    loop.fault("meter-2", sim::FaultKind::lost, false);
    EXPECT_TRUE(loop.run_until(Phase::holding, 40)) << "seed " << seed << " " << loop.describe();
    EXPECT_TRUE(loop.status().alarms.empty()) << loop.describe();
  }
}

bool accused(const ClosedLoop& loop, const std::string& device = "meter") {
  for (const Alarm& alarm : loop.status().alarms)
    if (alarm.device.rfind(device, 0) == 0 && alarm.text.find("cannot be believed") != std::string::npos) return true;
  return false;
}

std::vector<double> scaled(std::vector<double> level, double share) {
  for (double& one : level) one *= share;
  return level;
}

TEST(HonestMeters, AreNotAccusedAfterBigStepsOfLevel) {
  int accusations = 0;
  for (std::uint64_t seed = 1; seed <= 36; ++seed) {
    sim::Deviations deviations = seeded(seed);
    const double lamp_lags_s[] = {0.05, 0.4, 1.2}, meter_lags_s[] = {0.15, 0.5};
    deviations.lamp_lag_s = lamp_lags_s[seed % 3];
    deviations.meter_lag_s = meter_lags_s[seed % 2];
    ClosedLoop loop(make_hall(seed), deviations);
    loop.apply();
    loop.run(15);
    for (const double share : {0.05, 1.0, 0.02, 0.6, 0.05, 1.0}) {
      loop.show.apply(loop.now, scaled(loop.hall.plan, share));
      bool once = false;
      for (int i = 0; i < 100; ++i) {
        loop.run(0.1);
        if (!once && accused(loop)) {
          once = true;
          ++accusations;
          ADD_FAILURE() << "seed " << seed << ", step to " << share << ", lamp " << deviations.lamp_lag_s << " s\n"
                        << loop.describe();
        }
      }
    }
    EXPECT_LE(loop.worst_limit_share(), 1) << "seed " << seed;
  }
  EXPECT_EQ(accusations, 0);
}

TEST(ALyingMeter, IsFoundWithinTwoSecondsAllTheSame) {
  double longest_s = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    for (const double factor : {0.1, 0.5, 0.7, 1.4, 2.0, 10.0}) {
      ClosedLoop loop(make_hall(seed), seeded(seed));
      loop.apply();
      ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
      loop.run(2);
      loop.fault("meter-3", sim::FaultKind::lying, true, factor);
      const double begin_s = loop.seconds();
      EXPECT_TRUE(loop.run_until([&] { return accused(loop, "meter-3"); }, 5)) << seed << " × " << factor;
      longest_s = std::max(longest_s, loop.seconds() - begin_s);
    }
  }
  std::printf("a meter that begins to lie by 30 %% or more is found within %.2f s\n", longest_s);
  EXPECT_LE(longest_s, 2.0);
}

}  // namespace
}  // namespace luxrig::scenarios
