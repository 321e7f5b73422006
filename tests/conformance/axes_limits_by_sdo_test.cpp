// Drives whose PDOs cannot carry profile speed and accelerations. The driver writes these by SDO before each move, and
// both axes of the head still begin and arrive together.
#include <gtest/gtest.h>

#include <cmath>

#include "core/output/head_move.h"
#include "tests/conformance/axes_bench.h"

namespace luxrig {
namespace {

using sim::FaultKind;

const std::string kPanAxis = "head (pan axis)", kTiltAxis = "head (tilt axis)";
constexpr std::uint32_t kAnswerOfTilt = 0x586;  ///< of its SDO server
const char* const kRemark = "node 6 cannot be told speed and acceleration by PDO";

std::uint16_t object_of(const can::CanFrame& frame) {
  return static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
}
bool is_limit(std::uint16_t index) { return index == 0x6081 || index == 0x6083 || index == 0x6084; }

/// Largest distance of the tilt from the straight line between two postures.
double off_the_line_deg(const std::vector<Joints>& path, const Joints& from, const Joints& to) {
  double worst = 0;
  for (const Joints& at : path) {
    const double share = (at.pan_rad - from.pan_rad) / (to.pan_rad - from.pan_rad);
    const double on_line_rad = from.tilt_rad + share * (to.tilt_rad - from.tilt_rad);
    worst = std::max(worst, std::abs(deg_from_rad(at.tilt_rad - on_line_rad)));
  }
  return worst;
}

/// Runs until the head rests and accepts an order.
void rest_at(AxesBench& bench, const Joints& aim) {
  bench.aim = aim;
  ASSERT_TRUE(bench.arrive()) << (bench.result ? "" : bench.result.error().detail);
  bench.run(1);
  bench.path.clear();
  bench.sent.clear();
}

class LimitsBySdo : public ::testing::TestWithParam<int> {};

TEST_P(LimitsBySdo, ADriveThatRefusesTheMappingMovesInStepWithTheOther) {
  AxesBench bench;
  bench.faults.set(kTiltAxis, FaultKind::unmappable, true, GetParam());
  const Joints from = AxesBench::deg(-20, 15), to = AxesBench::deg(100, -45);
  rest_at(bench, from);
  EXPECT_EQ(bench.health(2).life, Life::active);
  EXPECT_NE(bench.health(2).detail.find(kRemark), std::string::npos) << bench.health(2).detail;
  EXPECT_EQ(bench.health(1).detail, "");
  const Time asked = bench.now;
  bench.aim = to;
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  EXPECT_LT(off_the_line_deg(bench.path, from, to), 0.2);
  const HeadMove move = head_move(120, 60, {90, 180}, {60, 120});
  EXPECT_NEAR(to_seconds(bench.moved_at - asked), move.seconds, 0.25) << "some cycles later, as fast";
  // On the wire: accelerations, then the speed, then the offer. Nothing goes to that node by RPDO 2 and 3.
  std::vector<std::uint16_t> told;
  bool offered = false;
  for (const can::CanFrame& frame : bench.sent) {
    EXPECT_NE(frame.id, 0x306u);
    EXPECT_NE(frame.id, 0x406u);
    if (frame.id == 0x606 && frame.data[0] == 0x23) told.push_back(object_of(frame));
    if (frame.id == 0x206 && (frame.data[0] & 0x10) != 0 && !offered) {
      offered = true;
      EXPECT_EQ(told, (std::vector<std::uint16_t>{0x6083, 0x6084, 0x6081}));
    }
    const bool pan_offered = frame.id == 0x205 && (frame.data[0] & 0x10) != 0;
    EXPECT_TRUE(!pan_offered || told.size() == 3) << "the pan waits";
  }
  EXPECT_TRUE(offered);
}

INSTANTIATE_TEST_SUITE_P(Refusals, LimitsBySdo, ::testing::Values(1, 2, 3));

TEST(LimitsBySdoOfBoth, AHeadMovesAndUnchangedLimitsAreNotResent) {
  AxesBench bench;
  for (const std::string& axis : {kPanAxis, kTiltAxis}) bench.faults.set(axis, FaultKind::unmappable, true, 1);
  const Joints from = AxesBench::deg(10, 0), to = AxesBench::deg(-60, 50);
  rest_at(bench, from);
  bench.aim = to;
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  EXPECT_LT(off_the_line_deg(bench.path, from, to), 0.2);
  bench.path.clear();
  bench.sent.clear();
  bench.aim = from;  // as far, so as fast
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  EXPECT_LT(off_the_line_deg(bench.path, to, from), 0.2);
  int told = 0;
  for (const can::CanFrame& frame : bench.sent)
    told += (frame.id == 0x605 || frame.id == 0x606) && frame.data[0] == 0x23 && is_limit(object_of(frame)) ? 1 : 0;
  EXPECT_LE(told, 6);
  // A new aim replaces the current one.
  bench.aim = AxesBench::deg(120, 90);
  bench.run(0.8);
  bench.aim = AxesBench::deg(-30, -20);
  EXPECT_TRUE(bench.arrive(8));
}

TEST(LimitsBySdoLate, LostAnswersHoldBothAxesAndMarkTheHeadFaulted) {
  AxesBench bench;
  bench.faults.set(kTiltAxis, FaultKind::unmappable, true, 1);
  const Joints from = AxesBench::deg(0, 10), to = AxesBench::deg(70, -40);
  rest_at(bench, from);
  const Time lost_until = bench.now + from_seconds(0.9);
  bench.lie = [&](can::CanFrame& frame) {
    if (frame.id == kAnswerOfTilt && bench.now < lost_until) frame.id = 0x7E6;
  };
  bench.aim = to;
  bench.run(0.8);
  EXPECT_LT(AxesBench::turned_deg(bench.joints(), from), 0.05) << "neither has begun";
  EXPECT_EQ(bench.health(2).life, Life::faulted) << "its light must not travel with it";
  ASSERT_TRUE(bench.arrive(12));
  bench.run(1);
  EXPECT_LT(off_the_line_deg(bench.path, from, to), 0.2);
  EXPECT_EQ(bench.health(1).life, Life::active) << bench.health(1).detail;
  EXPECT_EQ(bench.health(2).life, Life::active) << bench.health(2).detail;
}

TEST(LimitsBySdoRefused, ADriveThatRefusesThemBothWaysStandsStillAndReportsIt) {
  AxesBench bench;
  bench.faults.set(kTiltAxis, FaultKind::unmappable, true, 1);
  const Joints from = AxesBench::deg(0, 10);
  rest_at(bench, from);
  bench.lie = [&](can::CanFrame& frame) {
    if (frame.id != kAnswerOfTilt || frame.data[0] != 0x60 || !is_limit(object_of(frame))) return;
    frame.data[0] = 0x80;  // aborted: value range exceeded
    frame.data[4] = 0x30;
    frame.data[5] = 0x00;
    frame.data[6] = 0x09;
    frame.data[7] = 0x06;
  };
  bench.aim = AxesBench::deg(70, -40);
  bench.run(10);
  EXPECT_LT(AxesBench::turned_deg(bench.joints(), from), 0.05);
  EXPECT_NE(bench.health(2).detail.find("refuses object 6083"), std::string::npos) << bench.health(2).detail;
  EXPECT_EQ(bench.health(1).life, Life::faulted);
}

TEST(LimitsBySdoAnew, ADriveThatMapsAfterAResetGetsItsLimitsByPdo) {
  AxesBench bench;
  bench.faults.set(kTiltAxis, FaultKind::unmappable, true, 2);
  rest_at(bench, AxesBench::deg(0, 10));
  EXPECT_NE(bench.health(2).detail, "");
  bench.faults.set(kTiltAxis, FaultKind::unmappable, false);
  bench.faults.set(kTiltAxis, FaultKind::reset, true);
  bench.run(1);
  bench.faults.set(kTiltAxis, FaultKind::reset, false);
  bench.aim = AxesBench::deg(30, 30);
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  EXPECT_EQ(bench.health(2).detail, "");
  bench.sent.clear();
  bench.aim = AxesBench::deg(50, 0);
  ASSERT_TRUE(bench.arrive());
  EXPECT_TRUE(std::any_of(bench.sent.begin(), bench.sent.end(), [](const auto& frame) { return frame.id == 0x306; }));
}

}  // namespace
}  // namespace luxrig
