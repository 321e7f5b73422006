#include "core/calibration/meter_timing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace luxrig {
namespace {

/// Shows what was `latency_s` ago, through a lag of first order, in noise that is a share of it.
class LateMeter {
 public:
  LateMeter(double latency_s, double lag_s, double noise, unsigned seed)
      : latency_s_(latency_s), lag_s_(lag_s), noise_(noise), random_(seed) {}

  /// changes: (time, lux), ascending; dark before.
  double shows(std::span<const TimedLux> changes, double at_s) {
    double shown = 0, since_s = -1e3, light = 0;
    for (const TimedLux& change : changes) {
      const double seen_s = change.at_s + latency_s_;
      if (seen_s > at_s) break;
      shown = light + (shown - light) * std::exp(-(seen_s - since_s) / lag_s_);
      light = change.lux;
      since_s = seen_s;
    }
    shown = light + (shown - light) * std::exp(-(at_s - since_s) / lag_s_);
    return shown * (1 + noise_ * std::normal_distribution<double>()(random_));
  }

 private:
  double latency_s_, lag_s_, noise_;
  std::mt19937_64 random_;
};

std::vector<TimedLux> around_a_step(LateMeter& meter, double lux, double period_s = 0.1) {
  const std::vector<TimedLux> changes = {{0, lux}};
  std::vector<TimedLux> samples;
  for (double t = -9 * period_s; t < 4; t += period_s) samples.push_back({t, meter.shows(changes, t)});
  return samples;
}

TEST(MeterTiming, IsNeverLaterThanTheOldLightGoesNorEarlierThanTheNewStands) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const double latency_s = 0.01 * (seed % 200), lag_s = 0.05 + 0.002 * (seed % 50);
    LateMeter meter(latency_s, lag_s, 0.005, seed);
    const auto timing = timing_of(around_a_step(meter, 100), 0, 0.05);
    ASSERT_TRUE(timing) << seed;
    EXPECT_LE(timing->delay_s, latency_s + 0.05 * lag_s + 1e-9) << seed;
    EXPECT_GT(timing->delay_s, latency_s - 0.2) << seed;
    EXPECT_GE(timing->settled_s + 0.05, latency_s + lag_s * std::log(1 / 0.01)) << seed;
    EXPECT_LT(timing->settled_s, latency_s + 8 * lag_s + 0.4) << seed;
    EXPECT_NEAR(timing->period_s, 0.1, 1e-9);
  }
}

// The last sample that noise lets be on the way is a matter of luck: each light would stay for half a second longer.
TEST(MeterTiming, NoiseDoesNotMakeAMeterSlow) {
  int early = 0;
  double mean_late_s = 0;
  constexpr int kMeters = 200;
  for (unsigned seed = 0; seed < kMeters; ++seed) {
    const double latency_s = 0.01 * (seed % 200), lag_s = 0.05 + 0.002 * (seed % 50);
    LateMeter meter(latency_s, lag_s, 0.02, seed);
    const auto timing = timing_of(around_a_step(meter, 100, 0.2), 0, 0);
    ASSERT_TRUE(timing) << seed;
    const double late_s = timing->settled_s - (latency_s + lag_s * std::log(1 / 0.005));
    EXPECT_LT(late_s, 0.8) << seed;
    EXPECT_GE(timing->settled_s, latency_s + lag_s * std::log(1 / 0.06) - 0.05) << seed;
    mean_late_s += std::abs(late_s) / kMeters;
    // Half a per cent of the step is left in truth; 2 % are no more than the noise.
    early += timing->settled_s < latency_s + lag_s * std::log(1 / 0.02) - 1e-9;
  }
  RecordProperty("mean_late_s", std::to_string(mean_late_s));
  EXPECT_LT(mean_late_s, 0.15);
  EXPECT_LE(early, kMeters / 20);
}

TEST(MeterTiming, WithoutAClearStepThereIsNone) {
  LateMeter meter(0.5, 0.1, 0.02, 1);
  EXPECT_FALSE(timing_of(around_a_step(meter, 0), 0, 0));
  EXPECT_FALSE(timing_of({}, 0, 0));
  LateMeter slow(0.5, 5, 0.002, 1);  // still moving at the end
  EXPECT_FALSE(timing_of(around_a_step(slow, 100), 0, 0));
  auto short_of_dark = around_a_step(meter, 100);
  short_of_dark.erase(short_of_dark.begin(), short_of_dark.begin() + 8);
  EXPECT_FALSE(timing_of(short_of_dark, 0, 0));
}

TEST(ReadingLog, ReadsEachLightThoughALateMeterShowsItAfterItIsGone) {
  constexpr double kLux[] = {100, 3, 60, 0, 250};
  double chi_squared = 0;
  int count = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    LateMeter late(1.8, 0.12, 0.02, seed), quick(0.1, 0.05, 0.02, seed + 1000);
    std::vector<std::optional<MeterTiming>> timing = {timing_of(around_a_step(late, 200), 0, 0),
                                                      timing_of(around_a_step(quick, 200), 0, 0)};
    ASSERT_TRUE(timing[0] && timing[1]);
    const double dwell = dwell_s(timing);
    EXPECT_LT(dwell, 1.8) << "shorter than the late meter's delay";
    timing.emplace_back();  // a meter that showed nothing
    ReadingLog log(timing);
    std::vector<TimedLux> changes;
    double t = 0;
    for (const double lux : kLux) {
      changes.push_back({t, lux});
      log.light(t, t + dwell);
      t += dwell;
    }
    changes.push_back({t, 500});
    for (double at_s = 0.03; at_s < log.whole_at_s(); at_s += 0.1) {
      log.sample(0, {at_s, late.shows(changes, at_s)});
      log.sample(1, {at_s, quick.shows(changes, at_s)});
    }
    const auto readings = log.readings();
    for (std::size_t k = 0; k < std::size(kLux); ++k) {
      EXPECT_FALSE(readings[k][2]);
      for (std::size_t m = 0; m < 2; ++m) {
        if (!readings[k][m]) continue;  // three samples in a row may happen to rise
        const double off = (readings[k][m]->lux - kLux[k]) / readings[k][m]->standard_error_lx;
        // What is left of the light before, a share of the step, is no noise.
        if (kLux[k] >= 60) chi_squared += off * off, ++count;
        EXPECT_NEAR(readings[k][m]->lux, kLux[k], 0.04 * kLux[k] + 1.5) << seed << " light " << k << " meter " << m;
      }
    }
  }
  EXPECT_GT(count, 200);
  EXPECT_LT(chi_squared / count, 2);
}

// Of three samples the last is often far from the first by chance.
TEST(ReadingLog, NoiseIsNotTakenForLightThatWanders) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  constexpr int kLights = 2000;
  ReadingLog log({MeterTiming{0, 0.05, 0.1}});
  for (int light = 0; light < kLights; ++light) {
    log.light(light, light + 0.4);
    for (int k = 0; k < 3; ++k) log.sample(0, {light + 0.1 + 0.1 * k, 100 * (1 + 0.02 * normal(random))});
  }
  int read = 0;
  for (const auto& of_light : log.readings()) read += of_light[0].has_value();
  EXPECT_GE(read, 0.98 * kLights);
}

TEST(ReadingLog, LightThatWandersIsNotRead) {
  ReadingLog log({MeterTiming{0, 0.1, 0.1}});
  log.light(0, 1);
  log.light(1, 2);
  for (int k = 0; k < 20; ++k) log.sample(0, {0.1 * k + 0.05, k < 10 ? 100.0 + 5 * k : 200.0});
  const auto readings = log.readings();
  EXPECT_FALSE(readings[0][0]);
  ASSERT_TRUE(readings[1][0]);
  EXPECT_DOUBLE_EQ(readings[1][0]->lux, 200);
}

// A meter that is as late as always, but whose samples stop for a while: what comes then may be any light.
TEST(ReadingLog, ALightDuringWhichSamplesWereHeldUpIsNotRead) {
  for (const double pause_from_s : {10.2, 12.0, 14.6}) {
    ReadingLog log({MeterTiming{0.2, 0.5, 0.1}});
    for (int k = 0; k < 6; ++k) log.light(5.0 * k, 5.0 * k + 4.5);
    for (int k = 0; k < 320; ++k) {
      const double at_s = 0.1 * k;
      // Held up for two seconds, and then as late as that.
      if (at_s < pause_from_s || at_s > pause_from_s + 2) log.sample(0, {at_s, 100.0 + std::floor(at_s / 5)});
    }
    const auto readings = log.readings();
    for (std::size_t k = 0; k < readings.size(); ++k) {
      const double to_s = 5.0 * static_cast<double>(k) + 4.7;
      const double paused_s = std::min(to_s, pause_from_s + 2) - std::max(5.0 * static_cast<double>(k), pause_from_s);
      EXPECT_EQ(readings[k][0].has_value(), !(paused_s > 1)) << k << ", pause from " << pause_from_s;
    }
  }
}

}  // namespace
}  // namespace luxrig
