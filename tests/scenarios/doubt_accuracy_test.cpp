// doubt: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenarios/closed_loop.h"
#include "tests/scenarios/doubt_fixture.h"

namespace luxrig::scenarios {
namespace {

using namespace doubt_fixture;

std::vector<double> scaled(std::vector<double> level, double share) {
  for (double& one : level) one *= share;
  return level;
}

TEST(HonestMeters, AreNotDoubtedAfterLargeLevelSteps) {
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

TEST(AllMetersTogether, AreNotDoubtedInHonestHalls) {
  int off = 0, drift = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    ClosedLoop loop(make_hall(seed), seeded(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
    loop.run(10);
    loop.show.apply(loop.now, scaled(loop.hall.plan, seed % 2 == 0 ? 0.1 : 0.5));
    loop.run(25);
    off += says(loop, "than the model says");
    drift += says(loop, "than before at the same levels");
  }
  std::printf("honest halls: said to be off together in %d of 100, to drift in %d of 100\n", off, drift);
  EXPECT_LE(off, 2);
  EXPECT_EQ(drift, 0);
}

TEST(AMeterThatDrifts, IsReportedAndItsPointIsUnknown) {
  for (const double per_s : {0.003, -0.003}) {
    for (const bool all : {true, false}) {
      int said = 0;
      for (std::uint64_t seed = 61; seed <= 70; ++seed) {
        ClosedLoop loop(make_hall(seed), seeded(seed));
        loop.apply();
        ASSERT_TRUE(loop.run_until(Phase::holding, 40)) << loop.describe();
        loop.run(3);
        const double begin_s = loop.seconds();
        loop.corrupt = [&](LuxReading& reading) {
          if (all || reading.luxmeter == 4)
            reading.lux *= 1 + per_s * std::clamp(to_seconds(reading.taken - Time{}) - begin_s, 0.0, 75.0);
        };
        loop.run(90);
        const char* text = all ? "most meters read" : "luxmeter \"meter-5\" reads";
        const bool is_said = says(loop, text) || accused(loop);
        said += is_said;
        EXPECT_FALSE(loop.status().points[4].met()) << "seed " << seed << " " << loop.describe();
        EXPECT_NE(loop.status().points[4].verdict, Verdict::missed) << loop.describe();
      }
      EXPECT_EQ(said, 10) << (all ? "all" : "one") << " by " << per_s << " a second";
    }
  }
}

}  // namespace
}  // namespace luxrig::scenarios
