#include "core/calibration/head_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace luxrig {
namespace {

/// A head, its bus, and a meter with a delay and a lag; a beam that is seen within a few degrees.
struct Moved {
  double speed_rad_s = 2.5, obeys_s = 0.15, swings_s = 0;
  double bus_s = 0.03, meter_s = 0.6, lag_s = 0.1, period_s = 0.1, noise = 0.01;
  std::mt19937_64 random{5};

  /// What is at the meter so long after the order.
  [[nodiscard]] double light(double way_rad, double after_s) const {
    if (way_rad == 0) return after_s > bus_s ? 300 : 0;
    const double moves_s = after_s - bus_s - obeys_s;
    double off_rad = std::clamp(way_rad - speed_rad_s * moves_s, 0.0, way_rad);
    const double over_s = moves_s - way_rad / speed_rad_s;
    if (swings_s > 0 && over_s > 0 && over_s < swings_s) off_rad = 0.06 * (1 - over_s / swings_s);
    return 300 * std::exp(-off_rad * off_rad / (2 * 0.05 * 0.05));
  }
  LightReturn move(double way_rad) {
    std::normal_distribution<double> normal;
    const double phase_s = std::uniform_real_distribution<double>(0, period_s)(random);
    LightReturn back{way_rad, way_rad > 0 ? 0.05 * std::sqrt(2 * std::log(2)) : 0, 100, {}};
    double shown = light(way_rad, -2);
    constexpr double kStep_s = 0.002;
    double next_s = -2 + phase_s;
    for (double t = -2; t < way_rad / speed_rad_s + 4; t += kStep_s) {
      shown += (light(way_rad, t - meter_s) - shown) * std::min(1.0, kStep_s / lag_s);
      if (t < next_s) continue;
      next_s += period_s;
      back.samples.push_back({100 + t, (20 + shown) * (1 + noise * normal(random))});
    }
    return back;
  }
  HeadMotion motion() {
    std::vector<LightReturn> pan, tilt, switched;
    for (const double way_rad : {0.6, 0.6, 2.4, 2.4}) pan.push_back(move(way_rad));
    for (const double way_rad : {0.5, 0.5, 1.4, 1.4}) tilt.push_back(move(way_rad));
    for (int k = 0; k < 2; ++k) switched.push_back(move(0));
    return head_motion(pan, tilt, switched);
  }
};

double deg(double rad) { return rad * 180 / std::numbers::pi; }

TEST(HeadMotion, IsItsSpeedAndItsSettlingWithinTheirErrors) {
  int runs = 0, within_two = 0;
  for (const double speed_rad_s : {0.8, 2.5, 4.0})
    for (const double period_s : {0.05, 0.1, 0.25})
      for (const double lag_s : {0.02, 0.2})
        for (unsigned seed = 1; seed <= 6; ++seed) {
          Moved head;
          head.random.seed(seed);
          head.speed_rad_s = speed_rad_s;
          head.period_s = period_s;
          head.lag_s = lag_s;
          const HeadMotion motion = head.motion();
          for (const Known& speed : {motion.pan_speed_deg_s, motion.tilt_speed_deg_s}) {
            if (speed.standard_error == 0) {
              EXPECT_GT(speed_rad_s * period_s, 0.2) << "it is too fast for so slow a meter only";
              continue;
            }
            ++runs;
            const double off = std::abs(speed.value - deg(speed_rad_s)) / speed.standard_error;
            within_two += off < 2;
            EXPECT_LT(off, 4.5) << speed_rad_s << ' ' << period_s << ' ' << lag_s;
            EXPECT_LT(speed.standard_error, 0.34 * speed.value);
          }
          if (motion.settling_s.standard_error == 0) continue;
          EXPECT_NEAR(motion.settling_s.value, head.obeys_s, 4 * motion.settling_s.standard_error + 0.03);
        }
  EXPECT_GT(runs, 180);
  EXPECT_GT(within_two, 0.9 * runs);
}

TEST(HeadMotion, OfAHeadThatSwingsOutIsLonger) {
  Moved head;
  head.swings_s = 0.8;
  const HeadMotion motion = head.motion();
  EXPECT_NEAR(motion.pan_speed_deg_s.value, deg(2.5), 3 * motion.pan_speed_deg_s.standard_error);
  EXPECT_GT(motion.settling_s.value, 0.5);
  EXPECT_LT(motion.settling_s.value, 1.1);
}

TEST(HeadMotion, IsNotKnownFromOneWayOrWithoutLight) {
  Moved head;
  const std::vector<LightReturn> one_way{head.move(1), head.move(1), head.move(1)};
  const HeadMotion motion = head_motion(one_way, {}, {});
  EXPECT_EQ(motion.pan_speed_deg_s, Known{});
  EXPECT_EQ(motion.tilt_speed_deg_s, Known{});
  EXPECT_EQ(motion.settling_s, Known{});
  LightReturn dark = head.move(1);
  for (TimedLux& sample : dark.samples) sample.lux = 20;
  EXPECT_FALSE(light_arrival(dark));
  EXPECT_FALSE(light_arrival({}));
  LightReturn cut = head.move(1);
  cut.samples.resize(cut.samples.size() * 2 / 5);
  EXPECT_FALSE(light_arrival(cut)) << "the light was not there yet";
}

TEST(HeadMotion, GoesToTheHeadAsFarAsItIsKnown) {
  CalibratedHead head;
  head.pan_speed_deg_s = {150, 3};
  put_motion({{}, {90, 2}, {0.3, 0.1}}, head);
  EXPECT_EQ(head.pan_speed_deg_s, (Known{150, 3}));
  EXPECT_EQ(head.tilt_speed_deg_s, (Known{90, 2}));
  EXPECT_EQ(head.settling_s, (Known{0.3, 0.1}));
}

}  // namespace
}  // namespace luxrig
