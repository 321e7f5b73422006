#include "core/show/meter_readings.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

class MeterReadingsTest : public ::testing::Test {
 protected:
  bool hear(std::size_t luxmeter, double lux, bool lost = false) {
    now += std::chrono::milliseconds(100);
    return readings.hear(now, {luxmeter, lux, now}, lost);
  }
  void take_sample(double lux) {
    for (std::size_t i = 0; i < MeterSamples::kReadings; ++i) hear(0, lux);
    ASSERT_TRUE(readings.has_sample(now, 0));
    const LuxReading sample = readings.sample(0);
    readings.take(now, std::span(&sample, 1));
    readings.believe(sample);
  }

  MeterReadings readings{2};
  Time now{};
};

TEST_F(MeterReadingsTest, ALostMeterIsHeardButNotBelieved) {
  EXPECT_TRUE(hear(0, 100));
  EXPECT_TRUE(hear(0, 300, true));
  EXPECT_EQ(readings.heard()[0]->lux, 300);
  EXPECT_EQ(readings.believed()[0]->lux, 100);
  EXPECT_FALSE(readings.heard()[1]);
}

TEST_F(MeterReadingsTest, ARefusedReadingChangesNothing) {
  hear(0, 100);
  EXPECT_FALSE(readings.hear(now, {0, 200, now}, false)) << "not after the one before";
  EXPECT_FALSE(readings.hear(now, {0, 200, now + std::chrono::seconds(1)}, false)) << "of the future";
  EXPECT_FALSE(readings.hear(now, {2, 200, now}, false)) << "of no meter";
  EXPECT_EQ(readings.heard()[0]->lux, 100);
}

TEST_F(MeterReadingsTest, ASampleIsTakenOnceAndItsChangeIsTracked) {
  take_sample(100);
  EXPECT_EQ(readings.sampled_at(), now);
  EXPECT_FALSE(readings.has_sample(now, 0)) << "the next one begins";
  EXPECT_TRUE(readings.changed(0));
  take_sample(100);
  EXPECT_FALSE(readings.changed(0)) << "its value stood still";
  take_sample(110);
  EXPECT_TRUE(readings.changed(0));
  EXPECT_EQ(readings.measured()[0]->lux, 110);
  readings.disbelieve(0);
  EXPECT_FALSE(readings.measured()[0]);
  EXPECT_TRUE(readings.believed()[0]);
}

TEST_F(MeterReadingsTest, AForgottenMeterLeavesNoReadings) {
  take_sample(100);
  hear(1, 50);
  readings.forget(0);
  EXPECT_FALSE(readings.heard()[0] || readings.believed()[0] || readings.measured()[0]);
  EXPECT_EQ(readings.heard()[1]->lux, 50);
}

}  // namespace
}  // namespace luxrig
