#include "core/show/scale_watch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxrig {
namespace {

constexpr std::size_t kMeters = 5;

/// Five meters, each below its own lamp that gives it 100 lx. The test sets their readings.
class ScaleWatchTest : public ::testing::Test {
 protected:
  static Rig rig_of_five() {
    Rig rig;
    rig.fixtures.resize(kMeters);
    rig.luxmeters.resize(kMeters);
    rig.points.resize(kMeters);
    for (std::size_t i = 0; i < kMeters; ++i) {
      rig.luxmeters[i].name = "meter-" + std::to_string(i);
      rig.luxmeters[i].point = i;
    }
    return rig;
  }
  static LightModel model_of_five() {
    LightModel model;
    model.point_lux_per_level = model.meter_lux_per_level = 100 * Eigen::MatrixXd::Identity(kMeters, kMeters);
    return model;
  }

  /// One sample a second: each meter reads this share of the model's value. 0 = no reading.
  void read(const std::vector<double>& shares, int samples = 5) {
    for (int sample = 0; sample < samples; ++sample) {
      now += std::chrono::seconds(1);
      measured.assign(kMeters, std::nullopt);
      for (std::size_t i = 0; i < kMeters; ++i)
        if (shares[i] > 0) measured[i] = LuxReading{i, 100 * shares[i], now};
      watch.look(now, estimator, measured, levels);
    }
  }
  [[nodiscard]] std::vector<Alarm> alarms() const {
    ShowStatus status;
    watch.tell(status, measured);
    return status.alarms;
  }

  Rig rig = rig_of_five();
  GainEstimator estimator{rig, model_of_five()};
  ScaleWatch watch{rig};
  std::vector<double> levels = std::vector<double>(kMeters, 1);
  std::vector<std::optional<LuxReading>> measured;
  Time now{};
};

TEST_F(ScaleWatchTest, RaisesNoAlarmForSteadyMeters) {
  read({1, 1.01, 0.99, 1, 1}, 50);
  EXPECT_TRUE(alarms().empty());
  EXPECT_EQ(watch.doubt_at(0, measured).log_share, 0);
}

TEST_F(ScaleWatchTest, NamesADriftingMeter) {
  read({1, 1, 1, 1, 1});
  read({1, 0.8, 1, 1, 1});
  ASSERT_EQ(alarms().size(), 1u);
  EXPECT_EQ(alarms()[0].device, "meter-1");
  EXPECT_NEAR(watch.doubt_at(1, measured).log_share, std::log(0.8), 1e-12);
  EXPECT_EQ(watch.doubt_at(0, measured).log_share, 0);
}

TEST_F(ScaleWatchTest, IgnoresAFewDeviatingSamples) {
  read({1, 1, 1, 1, 1});
  read({0.5, 1, 1, 1, 1}, 2);
  read({1, 1, 1, 1, 1}, 1);
  read({0.5, 1, 1, 1, 1}, 2);
  EXPECT_TRUE(alarms().empty());
}

TEST_F(ScaleWatchTest, MostMetersDriftingOneWayRaiseOneAlarm) {
  read({1, 1, 1, 1, 1});
  read({0.8, 0.82, 0.78, 1, 1});
  ASSERT_EQ(alarms().size(), 1u);
  EXPECT_EQ(alarms()[0].device, "");
  EXPECT_NE(alarms()[0].text.find("most meters read 20 % less"), std::string::npos) << alarms()[0].text;
  EXPECT_NEAR(watch.doubt_at(3, measured).log_share, std::log(0.8), 1e-12) << "what the model learned moved, too";
}

TEST_F(ScaleWatchTest, MetersDriftingOppositeWaysRaiseSeparateAlarms) {
  read({1, 1, 1, 1, 1});
  read({0.8, 0.8, 1.2, 1.2, 1});
  EXPECT_EQ(alarms().size(), 4u);
  for (const Alarm& alarm : alarms()) EXPECT_NE(alarm.device, "") << alarm.text;
  EXPECT_EQ(watch.doubt_at(4, measured).log_share, 0);
}

TEST_F(ScaleWatchTest, AMeterDriftingTheOtherWayKeepsItsOwnAlarm) {
  read({1, 1, 1, 1, 1});
  read({0.8, 0.8, 0.8, 1.2, 1});
  ASSERT_EQ(alarms().size(), 2u);
  EXPECT_EQ(alarms()[0].device, "meter-3");
  EXPECT_EQ(alarms()[1].device, "");
}

TEST_F(ScaleWatchTest, ForgettingDriftAcceptsTheLightAsItIs) {
  read({1, 1, 1, 1, 1});
  read({1, 0.8, 1, 1, 1});
  watch.forget_drift();
  EXPECT_TRUE(alarms().empty());
  read({1, 0.8, 1, 1, 1}, 20);
  EXPECT_TRUE(alarms().empty());
}

}  // namespace
}  // namespace luxrig
