#include <gtest/gtest.h>

#include <cmath>

#include "core/output/dimming.h"
#include "core/output/output_program.h"
#include "sim/devices/dimmer.h"
#include "sim/devices/dmx_fixture.h"
#include "sim/devices/head.h"
#include "sim/devices/luxmeter.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

TEST(SimulatedDimmer, RaisesTheNominalCurveToItsExponent) {
  for (const DimmerCurve curve : {DimmerCurve::linear, DimmerCurve::square, DimmerCurve::s_curve}) {
    Dimmer dimmer({curve, 1.08});
    for (const double drive : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      dimmer.set_drive(drive);
      dimmer.step(0.01);
      EXPECT_NEAR(dimmer.level(), std::pow(level_from_drive(curve, drive), 1.08), 1e-15);
    }
  }
}

TEST(SimulatedDimmer, ArrivesInFiniteTime) {
  Dimmer dimmer({.lag_s = 0.05});
  dimmer.set_drive(0.37);
  for (int i = 0; i < 200; ++i) dimmer.step(0.01);
  EXPECT_EQ(dimmer.level(), 0.37);
}

TEST(SimulatedHead, TurnsAtItsSpeedAndStopsAtItsTarget) {
  Head head(tiny_rig().fixtures[1]);  // 180°/s pan, 90°/s tilt
  head.set_target({kPi / 2, -kPi / 2});
  for (int i = 0; i < 50; ++i) head.step(0.01);
  EXPECT_NEAR(head.joints().pan_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(head.joints().tilt_rad, -kPi / 4, 1e-12);
  EXPECT_TRUE(head.moving());
  for (int i = 0; i < 51; ++i) head.step(0.01);
  EXPECT_FALSE(head.moving());
  EXPECT_EQ(head.joints().tilt_rad, -kPi / 2);
}

TEST(SimulatedHead, FollowsItsMotorsLateAndSettles) {
  HeadTruth truth;
  truth.speed_share = 0.9;
  truth.lag_s = 0.05;
  Head head(tiny_rig().fixtures[1], truth);  // 180°/s pan, 90°/s tilt
  head.set_target({kPi / 2, 0});
  for (int i = 0; i < 500; ++i) head.step(0.001);
  // Behind a ramp, a first-order lag is late by its time constant.
  EXPECT_NEAR(head.joints().pan_rad, 0.9 * kPi * (0.5 - 0.05), 0.01);
  for (int i = 0; i < 56; ++i) head.step(0.001);  // the motor stands still
  EXPECT_TRUE(head.moving());
  const double left_rad = kPi / 2 - head.joints().pan_rad;
  EXPECT_NEAR(left_rad, 0.9 * kPi * 0.05, 0.01);
  for (int i = 0; i < 100; ++i) head.step(0.001);
  EXPECT_NEAR(kPi / 2 - head.joints().pan_rad, left_rad * std::exp(-2.0), 1e-3);
  for (int i = 0; i < 600; ++i) head.step(0.001);
  EXPECT_FALSE(head.moving());
  EXPECT_EQ(head.joints().pan_rad, kPi / 2);
}

TEST(SimulatedHead, StaysWithinItsEndStops) {
  Head head(tiny_rig().fixtures[1]);
  head.set_target({100, -100});
  for (int i = 0; i < 1000; ++i) head.step(0.01);
  EXPECT_DOUBLE_EQ(head.joints().pan_rad, 1.5 * kPi);
  EXPECT_DOUBLE_EQ(head.joints().tilt_rad, -0.75 * kPi);
}

TEST(SimulatedHead, ZoomsAtItsSpeedFromTheNarrowEnd) {
  Fixture fixture = tiny_rig().fixtures[1];
  fixture.range.beam_min_rad = 0.1;
  fixture.range.beam_max_rad = 1;
  fixture.zoom_speed_rad_s = 0.5;
  Head head(fixture);
  EXPECT_EQ(head.joints().beam_rad, 0.1);
  head.set_target({0, 0, 0.6});
  for (int i = 0; i < 50; ++i) head.step(0.01);
  EXPECT_NEAR(head.joints().beam_rad, 0.35, 1e-12);
  EXPECT_TRUE(head.moving());
  for (int i = 0; i < 51; ++i) head.step(0.01);
  EXPECT_EQ(head.joints().beam_rad, 0.6);
  head.set_target({0, 0, 5});
  for (int i = 0; i < 500; ++i) head.step(0.01);
  EXPECT_EQ(head.joints().beam_rad, 1);
}

TEST(SimulatedLuxmeter, FollowsAStepWithItsLag) {
  MeterTruth truth;
  truth.lag_s = 0.15;
  truth.lux_per_count = 1e-6;
  LuxmeterDevice meter(truth);
  for (std::uint64_t tick = 1; tick <= 100; ++tick) {
    meter.step(500, 0.01, tick);
    if (tick % 20 == 0) {
      EXPECT_NEAR(meter.reading_lx(), 500 * (1 - std::exp(-0.01 * static_cast<double>(tick) / 0.15)), 1e-6);
    }
  }
  EXPECT_EQ(meter.sample(), 5u);  // five a second
}

TEST(SimulatedLuxmeter, FollowsTheSameInStepsOfAnyLength) {
  MeterTruth truth;
  truth.lag_s = 0.15;
  truth.ticks_per_sample = 1;
  truth.lux_per_count = 1e-9;
  LuxmeterDevice meter(truth);
  double at_s = 0;
  std::uint64_t tick = 0;
  for (const double step_s : {0.01, 0.03, 0.03, 0.01, 0.2, 0.01}) {
    at_s += step_s;
    meter.step(500, step_s, ++tick);
    EXPECT_NEAR(meter.reading_lx(), 500 * (1 - std::exp(-at_s / 0.15)), 1e-6);
  }
}

TEST(SimulatedLuxmeter, HoldsItsReadingBetweenSamples) {
  LuxmeterDevice meter(MeterTruth{});
  for (std::uint64_t tick = 1; tick <= 20; ++tick) meter.step(100, 0.01, tick);
  for (std::uint64_t tick = 21; tick <= 39; ++tick) {
    meter.step(900, 0.01, tick);
    EXPECT_NEAR(meter.reading_lx(), 100, 1e-9);
  }
  meter.step(900, 0.01, 40);
  EXPECT_NEAR(meter.reading_lx(), 900, 1e-9);
}

TEST(SimulatedLuxmeter, CountsWholeStepsAndClipsAtFullScale) {
  MeterTruth truth;
  truth.ticks_per_sample = 1;
  truth.lux_per_count = 0.5;
  truth.range_lx = 1000;
  LuxmeterDevice meter(truth);
  meter.step(10.3, 0.01, 1);
  EXPECT_DOUBLE_EQ(meter.reading_lx(), 10.5);
  meter.step(5000, 0.01, 2);
  EXPECT_DOUBLE_EQ(meter.reading_lx(), 1000);
}

TEST(SimulatedLuxmeter, NoiseHasTheStatedSize) {
  MeterTruth truth;
  truth.ticks_per_sample = 1;
  truth.noise = 0.003;
  truth.lux_per_count = 1e-6;
  LuxmeterDevice meter(truth);
  double sum = 0, squares = 0;
  constexpr int kSamples = 20000;
  for (int i = 1; i <= kSamples; ++i) {
    meter.step(100, 0.01, static_cast<std::uint64_t>(i));
    const double off = meter.reading_lx() / 100 - 1;
    sum += off;
    squares += off * off;
    EXPECT_LE(std::abs(off), 3 * 0.003 + 1e-7);
  }
  EXPECT_NEAR(sum / kSamples, 0, 5 * 0.003 / std::sqrt(kSamples));
  // Standard deviation of z ~ N(0, 1) clamped to ±3, with density φ and upper tail Q:
  // ∫₋₃³ z² φ dz + 9 · 2 Q(3) = (1 - 2 Q(3) - 6 φ(3)) + 18 Q(3), φ(3) = 0.0044318, Q(3) = 0.0013499
  // = 0.9707091 + 0.0242981 = 0.9950072 = 0.9975005²
  // 20000 draws determine it to 1/sqrt(2N) = 0.5 %; four times that is allowed.
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.003 * 0.9975, 0.003 * 0.02);
}

TEST(SimulatedDmxFixture, ReadsSixteenBitJointsAndDimmer) {
  const Rig rig = tiny_rig();
  const Fixture& head = rig.fixtures[1];
  std::array<std::uint8_t, kDmxSlots> slots{};
  // Address 10: pan 0x5555, tilt 0xD555, dimmer 0x8000, shutter open. ±270° and ±135°: pan -90°, tilt 90°.
  const std::uint8_t frame[] = {0x55, 0x55, 0xd5, 0x55, 0x80, 0x00, 255};
  std::copy(std::begin(frame), std::end(frame), slots.begin() + 9);
  const DmxOrder order = decode_slots(head, std::get<DmxPatch>(head.patch), slots);
  ASSERT_TRUE(order.joints);
  EXPECT_NEAR(deg_from_rad(order.joints->pan_rad), -90, 0.0083);
  EXPECT_NEAR(deg_from_rad(order.joints->tilt_rad), 90, 0.0042);
  EXPECT_DOUBLE_EQ(order.drive, 32768.0 / 65535.0);
}

TEST(SimulatedDmxFixture, IsDarkWhileItsShutterIsClosed) {
  const Rig rig = tiny_rig();
  const Fixture& head = rig.fixtures[1];
  std::array<std::uint8_t, kDmxSlots> slots;
  slots.fill(255);
  EXPECT_EQ(decode_slots(head, std::get<DmxPatch>(head.patch), slots).drive, 1);
  slots[15] = 254;
  EXPECT_EQ(decode_slots(head, std::get<DmxPatch>(head.patch), slots).drive, 0);
}

TEST(SimulatedDmxFixture, ReadsZeroBeyondTheUniverse) {
  Fixture spot = tiny_rig().fixtures[0];
  DmxPatch patch{1, 512, {{SlotUse::dimmer, 0}, {SlotUse::dimmer_fine, 0}}};
  std::array<std::uint8_t, kDmxSlots> slots;
  slots.fill(255);
  EXPECT_DOUBLE_EQ(decode_slots(spot, patch, slots).drive, 0xff00 / 65535.0);
}

}  // namespace
}  // namespace luxrig::sim
