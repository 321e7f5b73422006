// The simulated axis alone: its state machine against CiA 402-2, its motion against the closed form, its mechanics
// against the effects of friction, play and end stops.
#include "sim/devices/axis_drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/output/trapezoid.h"

namespace luxrig::sim {
namespace {

AxisDrive enabled(int mode, const AxisTruth& truth = {}) {
  AxisDrive drive(truth, 0);
  drive.set_power(true);
  drive.parameters.mode = static_cast<std::int8_t>(mode);
  drive.step(false);
  for (const int word : {0x06, 0x07, 0x0F}) drive.set_controlword(static_cast<std::uint16_t>(word));
  return drive;
}

int state_bits(const AxisDrive& drive) { return drive.statusword() & 0x6F; }

TEST(AxisDrive, FollowsTheStatesOfCiA402) {
  AxisDrive drive({}, 0);
  EXPECT_EQ(drive.statusword(), 0) << "without power";
  drive.set_power(true);
  EXPECT_EQ(drive.statusword() & 0x4F, 0x40);
  const auto after = [&](int word) {
    drive.set_controlword(static_cast<std::uint16_t>(word));
    return state_bits(drive);
  };
  EXPECT_EQ(after(0x0F) & 0x4F, 0x40) << "not from here";
  EXPECT_EQ(after(0x06), 0x21);
  EXPECT_EQ(after(0x07), 0x23);
  EXPECT_EQ(after(0x0F), 0x27);
  EXPECT_EQ(after(0x07), 0x23);
  EXPECT_EQ(after(0x06), 0x21);
  EXPECT_EQ(after(0x00) & 0x4F, 0x40);
  for (const int word : {0x06, 0x07, 0x0F}) (void)after(word);
  EXPECT_EQ(after(0x02), 0x07) << "quick stop";
  EXPECT_EQ(after(0x0F), 0x07) << "option 2 does not go back";
  drive.step(false);
  EXPECT_EQ(drive.statusword() & 0x4F, 0x40) << "and switches off at the end of its ramp";
  drive.parameters.quick_stop_option = 6;
  for (const int word : {0x06, 0x07, 0x0F, 0x02}) (void)after(word);
  drive.step(false);
  EXPECT_EQ(state_bits(drive), 0x07);
  EXPECT_EQ(after(0x0F), 0x27);
  drive.abort_connection(1);
  EXPECT_EQ(drive.statusword() & 0x4F, 0x08);
  EXPECT_EQ(drive.error_code(), 0x8130);
  EXPECT_EQ(after(0x0F) & 0x4F, 0x08);
  EXPECT_EQ(after(0x80) & 0x4F, 0x40) << "rising edge";
}

TEST(AxisDrive, MovesByTheClosedFormAndReachesItsTarget) {
  AxisDrive drive = enabled(1);
  drive.parameters.speed = 4000;  // 40 °/s
  drive.parameters.acceleration = drive.parameters.deceleration = 8000;
  for (const int target : {9000, 9200, -3000}) {
    const double way = std::abs(target - drive.position());
    drive.parameters.target = target;
    drive.set_controlword(0x3F);
    EXPECT_TRUE(drive.statusword() & 1 << 12);
    drive.set_controlword(0x2F);
    EXPECT_FALSE(drive.statusword() & 1 << 12);
    int ms = 0;
    double fastest = 0;
    for (; ms < 20000 && (ms < 5 || !(drive.statusword() & 1 << 10)); ++ms) {
      drive.step(false);
      fastest = std::max(fastest, std::abs(drive.speed_deg_s()));
    }
    EXPECT_NEAR(drive.position(), target, 1);
    EXPECT_NEAR(ms, 1000 * trapezoid_s(way, 4000, 8000), 40) << target << ": and the servo settles";
    EXPECT_LT(fastest, 40 * 1.05);
  }
}

TEST(AxisDrive, QueuesASetPointWithoutImmediateChange) {
  AxisDrive drive = enabled(1);
  drive.parameters.speed = 4000;
  drive.parameters.target = 2000;
  drive.set_controlword(0x1F);
  drive.set_controlword(0x0F);
  for (int ms = 0; ms < 100; ++ms) drive.step(false);
  drive.parameters.target = -500;
  drive.set_controlword(0x1F);
  drive.set_controlword(0x0F);
  EXPECT_TRUE(drive.statusword() & 1 << 12) << "kept until it is taken";
  int furthest = 0;
  for (int ms = 0; ms < 5000; ++ms) {
    drive.step(false);
    furthest = std::max(furthest, drive.position());
  }
  EXPECT_NEAR(furthest, 2000, 2);
  EXPECT_NEAR(drive.position(), -500, 1);
}

TEST(AxisDrive, KeepsToItsSoftLimitsOnceHomed) {
  AxisDrive drive = enabled(6);
  drive.parameters.homing_method = 35;
  drive.set_controlword(0x1F);
  for (int ms = 0; ms < 10; ++ms) drive.step(false);
  EXPECT_TRUE(drive.homed());
  EXPECT_EQ(drive.statusword() & 0x1400, 0x1400);
  drive.parameters.mode = 1;
  drive.parameters.lowest = -1000;
  drive.parameters.highest = 1000;
  drive.parameters.speed = 4000;
  drive.parameters.target = 3000;
  drive.step(false);
  drive.set_controlword(0x0F);
  drive.set_controlword(0x3F);
  EXPECT_TRUE(drive.statusword() & 1 << 11);
  for (int ms = 0; ms < 3000; ++ms) drive.step(false);
  EXPECT_NEAR(drive.position(), 1000, 1);
}

TEST(AxisDrive, HaltsAndReportsAFollowingErrorWhenBlocked) {
  AxisDrive drive = enabled(1);
  drive.parameters.speed = 4000;
  drive.parameters.target = 20000;
  drive.parameters.following_window = 200;
  drive.set_controlword(0x3F);
  for (int ms = 0; ms < 1000; ++ms) drive.step(false);
  EXPECT_GT(drive.speed_deg_s(), 30);
  drive.set_controlword(0x10F);
  for (int ms = 0; ms < 1000; ++ms) drive.step(false);
  EXPECT_NEAR(drive.speed_deg_s(), 0, 0.1);
  EXPECT_EQ(state_bits(drive), 0x27);
  drive.set_controlword(0x2F);
  drive.set_controlword(0x3F);
  for (int ms = 0; ms < 300; ++ms) drive.step(true);
  EXPECT_EQ(drive.error_code(), 0x8611);
  EXPECT_EQ(drive.statusword() & 0x4F, 0x08);
}

TEST(AxisMechanics, HasFrictionPlayAndEndStops) {
  AxisTruth truth;
  truth.stop_max_deg = 5;
  AxisMechanics axis(truth, 0);
  for (int ms = 0; ms < 100; ++ms) axis.step(0.001, 50, false);
  EXPECT_EQ(axis.speed_deg_s(), 0) << "less than dry friction turns nothing";
  for (int ms = 0; ms < 100; ++ms) axis.step(0.001, 360, false);
  const double speed = axis.speed_deg_s(), from = axis.motor_deg();
  EXPECT_NEAR(speed, 0.1 * (360 - 60), 1.0);
  EXPECT_NEAR(axis.motor_deg() - axis.joint_deg(), 0.01, 1e-12) << "the load hangs behind by half the play";
  for (int ms = 0; ms < 2000 && axis.speed_deg_s() > 0; ++ms) axis.step(0.001, 0, false);
  EXPECT_NEAR(axis.motor_deg() - from, std::min(speed * speed / (2 * 60), 5 - from), 0.5) << "it coasts";
  for (int ms = 0; ms < 2000; ++ms) axis.step(0.001, 500, false);
  EXPECT_EQ(axis.motor_deg(), 5);
  EXPECT_EQ(axis.speed_deg_s(), 0);
  const double joint = axis.joint_deg();
  while (axis.motor_deg() > 5 - 0.015) axis.step(0.001, -100, false);
  EXPECT_NEAR(axis.joint_deg(), joint, 0.006) << "turned back, the play comes first";
}

}  // namespace
}  // namespace luxrig::sim
