#include "core/estimation/meter_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/output/at.h"

namespace luxrig {
namespace {

LuxReading reading(double lux, double taken_s, std::size_t luxmeter = 0) { return {luxmeter, lux, at(taken_s)}; }

TEST(MeterSamples, GivesTheMedianOfTheLastFour) {
  MeterSamples samples(1);
  const double lux[] = {500, 100, 101, 1000, 99};
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(samples.add(at(i + 1), reading(lux[i], i + 1)));
  ASSERT_TRUE(samples.sample(0));
  EXPECT_EQ(samples.sample(0)->lux, 100.5);  // of 100, 101, 1000, 99
  EXPECT_EQ(samples.sample(0)->taken, at(5));
}

TEST(MeterSamples, ReturnsAStuckValueBitForBit) {
  for (int count = 2; count <= 4; ++count) {
    MeterSamples samples(1);
    for (int i = 1; i <= count; ++i) samples.add(at(i), reading(0.1, i));
    EXPECT_EQ(samples.sample(0)->lux, 0.1);
  }
}

TEST(MeterSamples, CountsOnlyReadingsTakenSinceTheLightSettled) {
  MeterSamples samples(1);
  samples.restart(at(10));
  for (int i = 1; i < 10; ++i) samples.add(at(i), reading(7, i));
  EXPECT_FALSE(samples.sample(0));
  EXPECT_EQ(samples.last(0)->lux, 7);
  samples.add(at(10), reading(8, 10));
  EXPECT_FALSE(samples.sample(0)) << "one reading is no sample";
  samples.add(at(11), reading(8, 11));
  EXPECT_EQ(samples.sample(0)->lux, 8);
  samples.restart(at(20));
  EXPECT_FALSE(samples.sample(0));
}

TEST(MeterSamples, WaitsLongerWhileReadingsStillDrift) {
  MeterSamples samples(1);
  const auto settling_lx = [](double at_s) { return 5 + 95 * std::exp(-at_s); };  // a lamp with a time constant of 1 s
  double ready_s = 0;
  for (int i = 1; i <= 60 && ready_s == 0; ++i) {
    samples.add(at(0.2 * i), reading(settling_lx(0.2 * i), 0.2 * i));
    if (samples.ready(at(0.2 * i), 0)) ready_s = 0.2 * i;
  }
  ASSERT_GT(ready_s, 0);
  EXPECT_NEAR(samples.sample(0)->lux, 5, 0.1) << "after " << ready_s << " s";
  samples.restart(at(20));
  for (int i = 0; i <= 80; ++i) samples.add(at(20 + 0.2 * i), reading(100 * std::pow(1.02, i), 20 + 0.2 * i));
  EXPECT_TRUE(samples.ready(at(36), 0)) << "nothing settles for so long: it is the light that changes";
}

TEST(MeterSamples, WaitsForAgreeingReadingsButNotForever) {
  MeterSamples samples(1);
  for (int i = 1; i <= 4; ++i) samples.add(at(i), reading(i % 2 ? 100 : 102, i));
  EXPECT_TRUE(samples.ready(at(4), 0));
  samples.next();
  EXPECT_FALSE(samples.ready(at(4), 0));
  for (int i = 5; i <= 8; ++i) samples.add(at(i), reading(i % 2 ? 100 : 120, i));
  EXPECT_FALSE(samples.ready(at(8), 0));
  EXPECT_FALSE(samples.ready(at(9.9), 0));
  EXPECT_TRUE(samples.ready(at(10), 0));
}

TEST(MeterSamples, AcceptsDarknessAsAReading) {
  MeterSamples samples(1);
  for (int i = 1; i <= 4; ++i) ASSERT_TRUE(samples.add(at(i), reading(0, i)));
  EXPECT_TRUE(samples.ready(at(4), 0));
  EXPECT_EQ(samples.sample(0)->lux, 0);
}

TEST(MeterSamples, RefusesInvalidReadings) {
  MeterSamples samples(1);
  ASSERT_TRUE(samples.add(at(1), reading(5, 1)));
  EXPECT_FALSE(samples.add(at(9), reading(std::nan(""), 2)));
  EXPECT_FALSE(samples.add(at(9), reading(std::numeric_limits<double>::infinity(), 2)));
  EXPECT_FALSE(samples.add(at(9), reading(-1, 2)));
  EXPECT_FALSE(samples.add(at(9), reading(5, 2, 1))) << "no such meter";
  EXPECT_FALSE(samples.add(at(9), reading(5, 10))) << "from the future";
  EXPECT_FALSE(samples.add(at(9), reading(6, 1))) << "the same instant again";
  EXPECT_FALSE(samples.add(at(9), reading(6, 0.5))) << "older than the one before";
  EXPECT_EQ(samples.last(0)->lux, 5);
}

}  // namespace
}  // namespace luxrig
