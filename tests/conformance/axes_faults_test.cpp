// A head's beam under faults, judged by the true angles of the simulated joints: no axis ever moves unasked.
#include <gtest/gtest.h>

#include "core/output/head_move.h"
#include "tests/conformance/axes_bench.h"

namespace luxrig {
namespace {

using sim::FaultKind;

const std::string kPan = "head (pan axis)", kTilt = "head (tilt axis)";

TEST(Axes, AreSetUpHomedAndTurned) {
  AxesBench bench;
  bench.run(2);
  EXPECT_EQ(bench.health(1).life, Life::faulted);
  EXPECT_NE(bench.health(1).detail.find("node 5 (Simulated axis) is on its way to its home position"),
            std::string::npos)
      << bench.health(1).detail;
  bench.aim = AxesBench::deg(40, -30);
  ASSERT_TRUE(bench.arrive()) << (bench.result ? "" : bench.result.error().detail);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bench.health(static_cast<std::size_t>(i)).life, Life::active);
  EXPECT_EQ(bench.health(0).errors, 0u);
  EXPECT_EQ(bench.health(1).errors, 0u);
  bench.run(0.5);
  const Time still = bench.now;
  bench.run(5);
  EXPECT_LT(bench.moved_at, still) << "it stays";
}

TEST(Axes, MoveWithoutAnAimOnlyToHomeAtStart) {
  AxesBench when_needed(rig_of_axes({{"home", std::string("when needed")}}));
  when_needed.run(5);
  EXPECT_EQ(when_needed.moved_at, Time{}) << "nobody has asked";
  EXPECT_EQ(when_needed.health(1).life, Life::active) << when_needed.health(1).detail;
  EXPECT_FALSE(when_needed.pan().homed());
  when_needed.aim = AxesBench::deg(10, 10);
  EXPECT_TRUE(when_needed.arrive());

  AxesBench at_start;
  at_start.run(60);
  EXPECT_TRUE(at_start.pan().homed());
  EXPECT_NEAR(deg_from_rad(at_start.joints().pan_rad), -175, 0.2) << "at its switch";
  const Time still = at_start.now;
  at_start.run(5);
  EXPECT_LT(at_start.moved_at, still);

  AxesBench never(rig_of_axes({{"home", std::string("never")}}));
  never.run(5);
  EXPECT_EQ(never.moved_at, Time{});
  EXPECT_EQ(never.health(2).life, Life::active) << never.health(2).detail;
}

TEST(Axes, EveryHomingMethodFindsTheHomePosition) {
  for (const int method : {17, 1, 18, 2, 33, 34, 35, 37}) {
    Rig rig = rig_of_axes({{"homing_method", std::int64_t{method}}});
    AxesPatch& axes = *rig.fixtures[0].axes;
    const bool positive = method == 18 || method == 2, switches = method < 33 && method != 0;
    // The tilt counts the other way: its negative switch is at the upper end of its travel.
    axes.pan.home_rad = rad_from_deg(!switches ? 0 : positive ? 175 : -175);
    axes.tilt.home_rad = rad_from_deg(!switches ? 0 : positive ? -125 : 125);
    AxesBench bench(rig);
    bench.aim = AxesBench::deg(12, 34);
    EXPECT_TRUE(bench.run_until(90, [&] { return bench.result.has_value() && bench.pan().homed(); })) << method;
    bench.run(20);
    // An index comes every turn of the motor, 10° of the joint: the rig file must say which one is home.
    const bool index = method < 3 || method == 33 || method == 34;
    const double pan_off = deg_from_rad(bench.joints().pan_rad) - 12,
                 tilt_off = deg_from_rad(bench.joints().tilt_rad) - 34;
    EXPECT_LT(std::abs(index ? std::remainder(pan_off, 10) : pan_off), 0.05) << method;
    EXPECT_LT(std::abs(index ? std::remainder(tilt_off, 10) : tilt_off), 0.05) << method;
    EXPECT_LT(std::abs(pan_off), 10.1) << method;
  }
}

TEST(Axes, MoveInStepAlongAStraightLine) {
  AxesBench bench;
  bench.aim = AxesBench::deg(-20, 15);
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  const Joints from = bench.joints(), to = AxesBench::deg(100, -45);
  bench.path.clear();
  bench.aim = to;
  const Time asked = bench.now;
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  double worst_deg = 0, fastest_pan_deg_s = 0, fastest_tilt_deg_s = 0;
  for (std::size_t i = 1; i < bench.path.size(); ++i) {
    const Joints& at = bench.path[i];
    const double share = (at.pan_rad - from.pan_rad) / (to.pan_rad - from.pan_rad);
    worst_deg = std::max(worst_deg,
                         std::abs(deg_from_rad(at.tilt_rad - (from.tilt_rad + share * (to.tilt_rad - from.tilt_rad)))));
    fastest_pan_deg_s =
        std::max(fastest_pan_deg_s, deg_from_rad(std::abs(at.pan_rad - bench.path[i - 1].pan_rad)) / 0.01);
    fastest_tilt_deg_s =
        std::max(fastest_tilt_deg_s, deg_from_rad(std::abs(at.tilt_rad - bench.path[i - 1].tilt_rad)) / 0.01);
  }
  EXPECT_LT(worst_deg, 0.2) << "off the line";
  EXPECT_LT(fastest_pan_deg_s, 90 * 1.02);
  EXPECT_LT(fastest_tilt_deg_s, 60 * 1.02);
  // 120° at 90 °/s and 180 °/s², 60° at 60 °/s and 120 °/s²: the pan binds, 1.833 s.
  const HeadMove move = head_move(120, 60, {90, 180}, {60, 120});
  EXPECT_NEAR(move.seconds, 120.0 / 90 + 90.0 / 180, 1e-9);
  EXPECT_NEAR(to_seconds(bench.moved_at - asked), move.seconds, 0.15) << "and the handshake";
}

TEST(Axes, ANewAimReplacesTheCurrentOne) {
  AxesBench bench;
  bench.aim = AxesBench::deg(0, 0);
  ASSERT_TRUE(bench.arrive());
  bench.aim = AxesBench::deg(150, 100);
  bench.run(0.8);
  EXPECT_GT(deg_from_rad(bench.joints().pan_rad), 5);
  bench.aim = AxesBench::deg(-30, -20);
  ASSERT_TRUE(bench.arrive(5));
  double furthest = 0;
  for (const Joints& at : bench.path) furthest = std::max(furthest, deg_from_rad(at.pan_rad));
  EXPECT_LT(furthest, 100);
}

TEST(Axes, AMovingAxisBrakesForANearAimAtItsLimit) {
  AxesBench bench;
  bench.aim = AxesBench::deg(0, 0);
  ASSERT_TRUE(bench.arrive());
  bench.aim = AxesBench::deg(150, 100);
  bench.run(1.2);
  const double tilt_deg = deg_from_rad(bench.joints().tilt_rad), speed = std::abs(bench.tilt().speed_deg_s());
  ASSERT_GT(speed, 40);
  bench.path.clear();
  bench.aim = AxesBench::deg(150, tilt_deg);
  ASSERT_TRUE(bench.arrive(8));
  double furthest = 0;
  for (const Joints& at : bench.path) furthest = std::max(furthest, deg_from_rad(at.tilt_rad));
  EXPECT_LT(furthest - tilt_deg, speed * speed / (2 * 120) + speed * 0.1) << "and the handshake";
}

/// The head at rest at (20, 10), and on its way to (140, -80) for a second.
struct OnItsWay : AxesBench {
  explicit OnItsWay(Rig the_rig = rig_of_axes()) : AxesBench(std::move(the_rig)) {
    aim = deg(20, 10);
    EXPECT_TRUE(arrive());
    aim = deg(140, -80);
    run(1);
    EXPECT_GT(std::abs(pan().speed_deg_s()), 30);
    EXPECT_GT(std::abs(tilt().speed_deg_s()), 20);
  }
};

TEST(AxesFaults, ALostAxisStopsTheOtherAndBothResumeWhenItReturns) {
  OnItsWay bench;
  bench.faults.set(kPan, FaultKind::silent, true);  // its cable is cut: it does not hear the master either
  const Time gone = bench.now;
  ASSERT_TRUE(bench.run_until(1, [&] { return bench.health(1).life == Life::faulted; }));
  EXPECT_LE(bench.now - gone, bench.driver->bounds().fault_after + bench.driver->bounds().write_period);
  EXPECT_NE(bench.health(1).detail.find("no heartbeat for 300 ms"), std::string::npos) << bench.health(1).detail;
  EXPECT_EQ(bench.health(0).life, Life::active) << "the bus itself is well";
  bench.run(1.5);
  EXPECT_NE(bench.health(2).detail.find("the other axis of its head"), std::string::npos) << bench.health(2).detail;
  EXPECT_EQ(bench.pan().speed_deg_s(), 0) << "it missed the master";
  EXPECT_EQ(bench.tilt().speed_deg_s(), 0);
  const Time still = bench.now;
  bench.run(3);
  EXPECT_LT(bench.moved_at, still);
  EXPECT_FALSE(bench.result);

  bench.faults.clear();
  const Joints at = bench.joints();
  ASSERT_TRUE(bench.arrive(8)) << "without homing: it was never off";
  EXPECT_TRUE(bench.pan().homed());
  for (std::size_t i = bench.path.size() - 100; i < bench.path.size(); ++i)
    EXPECT_GE(bench.path[i].pan_rad, at.pan_rad - 1e-3) << "no way back to a switch";
  EXPECT_EQ(bench.health(1).life, Life::active);
}

TEST(AxesFaults, AResetAxisIsSetUpAndHomedAgainWhileTheOtherWaits) {
  OnItsWay bench;
  bench.faults.set(kTilt, FaultKind::reset, true);
  bench.run(0.5);
  EXPECT_EQ(bench.health(2).life, Life::faulted);
  EXPECT_FALSE(bench.tilt().homed());
  bench.run(0.5);
  EXPECT_EQ(bench.pan().speed_deg_s(), 0);
  // The head is not reported as back while its beam still travels.
  bench.each_cycle = [&] {
    if (bench.result) {
      EXPECT_LT(AxesBench::turned_deg(bench.joints(), *bench.aim), 0.6);
    }
  };
  ASSERT_TRUE(bench.arrive(60));
  EXPECT_TRUE(bench.tilt().homed());
}

TEST(AxesFaults, AResetAxisWithHomingWhenNeededStaysUnhomedUntilNeeded) {
  AxesBench bench(rig_of_axes({{"home", std::string("when needed")}}));
  bench.run(3);
  bench.faults.set(kTilt, FaultKind::reset, true);
  bench.run(5);
  EXPECT_EQ(bench.moved_at, Time{});
}

TEST(AxesFaults, APowerLossLetsTheAxisCoastAndLoseItsPosition) {
  OnItsWay bench;
  const double speed = std::abs(bench.pan().speed_deg_s()), before = deg_from_rad(bench.joints().pan_rad);
  bench.faults.set(kPan, FaultKind::dead, true);
  bench.run(3);
  const double coasted = std::abs(deg_from_rad(bench.joints().pan_rad) - before);
  EXPECT_GT(coasted, speed * speed / (2 * 140)) << "friction alone stops it";
  EXPECT_LT(coasted, speed * speed / (2 * 60) + 0.1);
  EXPECT_EQ(bench.health(1).life, Life::faulted);
  const Time still = bench.now;
  bench.run(2);
  EXPECT_LT(bench.moved_at, still);
  bench.faults.clear();
  bench.run(0.5);
  EXPECT_FALSE(bench.pan().homed());
  ASSERT_TRUE(bench.arrive(60)) << bench.health(1).detail;
  EXPECT_TRUE(bench.pan().homed());
}

TEST(AxesFaults, ABlockedAxisIsResetThreeTimesAndThenLeftAlone) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.arrive());
  bench.faults.set(kPan, FaultKind::stuck, true);
  bench.aim = AxesBench::deg(60, 10);
  ASSERT_TRUE(bench.run_until(3, [&] { return bench.health(1).life == Life::faulted; }));
  EXPECT_NE(bench.health(1).detail.find("following error (8611)"), std::string::npos) << bench.health(1).detail;
  ASSERT_TRUE(bench.run_until(20, [&] { return bench.health(1).detail.find("4 times in a row") != std::string::npos; }))
      << bench.health(1).detail;
  const auto resets = [&] {
    int count = 0;
    for (std::size_t i = 1; i < bench.sent.size(); ++i)
      count += bench.sent[i].id == 0x205 && bench.sent[i].data[0] == 0x80;
    return count;
  };
  const int before = resets();
  bench.run(0.5);
  bench.faults.clear();
  const Time still = bench.now;
  bench.run(20);
  EXPECT_EQ(resets(), before);
  EXPECT_LT(bench.moved_at, still);
  bench.faults.set(kPan, FaultKind::dead, true);  // a person switches it off and on
  bench.run(1);
  bench.faults.clear();
  EXPECT_TRUE(bench.arrive(60)) << bench.health(1).detail;
}

TEST(AxesFaults, BusOffStopsTheAxesAndTheyResumeAfterwards) {
  OnItsWay bench;
  bench.faults.set("the-bus", FaultKind::bus_off, true);
  bench.run(0.1);
  EXPECT_EQ(bench.health(0).life, Life::faulted);
  EXPECT_NE(bench.health(0).detail.find("bus-off"), std::string::npos) << bench.health(0).detail;
  const std::size_t sent = bench.sent.size();
  bench.run(2);
  EXPECT_EQ(bench.sent.size(), sent) << "what would be sent would be old when the bus is back";
  EXPECT_EQ(bench.pan().speed_deg_s(), 0);
  EXPECT_EQ(bench.tilt().speed_deg_s(), 0);
  EXPECT_EQ(bench.pan().statusword() & 0x6F, 0x07) << "quick stop active, held";
  bench.aim = AxesBench::deg(100, 0);
  bench.faults.clear();
  ASSERT_TRUE(bench.arrive(8)) << bench.health(0).detail << bench.health(1).detail;
}

TEST(AxesFaults, ADeadMasterStopsTheAxesWhichHoldOrReleaseAsConfigured) {
  for (const bool hold : {true, false}) {
    OnItsWay bench(rig_of_axes({{"on_stop", std::string(hold ? "hold" : "release")}}));
    const Time died = bench.now;
    bench.run_world(bench.now + std::chrono::milliseconds(1500));
    EXPECT_EQ(bench.pan().speed_deg_s(), 0);
    EXPECT_LE(bench.moved_at - died, std::chrono::milliseconds(310 + 700)) << "heard missing, and slowed down";
    EXPECT_EQ(bench.pan().statusword() & 0x6F, hold ? 0x07 : 0x40);
  }
}

TEST(AxesFaults, DeactivationStopsThemAtOnce) {
  OnItsWay bench;
  bench.driver->deactivate(bench.now);
  const Time stopped = bench.now;
  bench.run_world(bench.now + std::chrono::milliseconds(1500));
  EXPECT_LE(bench.moved_at - stopped, std::chrono::milliseconds(700)) << "before the heartbeat is missed";
  EXPECT_EQ(bench.tilt().statusword() & 0x6F, 0x07);
  EXPECT_EQ(bench.health(1).life, Life::configured);
}

TEST(AxesFaults, LostLateAndDuplicateFramesDelayButNeverDivertAMove) {
  for (const FaultKind kind : {FaultKind::lost, FaultKind::slow, FaultKind::duplicated}) {
    AxesBench bench;
    bench.aim = AxesBench::deg(20, 10);
    ASSERT_TRUE(bench.arrive());
    bench.faults.set("the-bus", kind, true, kind == FaultKind::slow ? 60 : 0.2);
    bench.path.clear();
    bench.aim = AxesBench::deg(60, -30);
    EXPECT_TRUE(bench.arrive(30)) << name_of(kind) << bench.health(1).detail;
    for (const Joints& at : bench.path) {
      ASSERT_GT(deg_from_rad(at.pan_rad), 19.9) << name_of(kind);
      ASSERT_LT(deg_from_rad(at.pan_rad), 60.1) << name_of(kind);
      ASSERT_GT(deg_from_rad(at.tilt_rad), -30.1) << name_of(kind);
      ASSERT_LT(deg_from_rad(at.tilt_rad), 10.1) << name_of(kind);
    }
  }
}

TEST(AxesFaults, GarbledFramesOfANodeNeverDriveTheHeadFarAstray) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.arrive());
  bench.faults.set(kPan, FaultKind::garbled, true);
  bench.path.clear();
  bench.run(10);
  for (const Joints& at : bench.path) ASSERT_LT(AxesBench::turned_deg(at, *bench.aim), 200);
  bench.faults.clear();
  EXPECT_TRUE(bench.arrive(60)) << bench.health(1).detail;
}

TEST(AxesFaults, AHeadAimedFromAWrongPositionStillArrives) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.arrive());
  for (int i = 0; i < 20; ++i) {
    bench.faults.set(kPan, FaultKind::garbled, true);
    bench.aim = AxesBench::deg(i % 2 != 0 ? 60 : -60, i % 3 * 20.0 - 20);
    bench.run(0.3 + 0.07 * i);
    bench.faults.clear();
    EXPECT_TRUE(bench.arrive(60)) << i << ": " << bench.health(1).detail;
    bench.run(31);  // faults in a row are forgotten
  }
}

TEST(AxesFaults, AFullQueueSlowsSendingAndADownedInterfaceIsReopened) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.arrive());
  bench.taken = can::Sent::queue_full;
  bench.sent.clear();
  bench.run(2);
  EXPECT_LE(bench.sent.size(), 16u) << "tried ever more seldom, at least five times a second";
  EXPECT_GE(bench.sent.size(), 8u);
  bench.taken = can::Sent::yes;
  ASSERT_TRUE(bench.arrive(5));

  const int opened = bench.opened;
  bench.broken = Fault{Cause::network, "", "sending on can0: Network is down", {}};
  ASSERT_TRUE(bench.run_until(1, [&] { return bench.health(0).life == Life::faulted; }));
  EXPECT_NE(bench.health(0).detail.find("Network is down"), std::string::npos) << bench.health(0).detail;
  bench.run(3);
  bench.broken.reset();
  bench.aim = AxesBench::deg(0, 0);
  ASSERT_TRUE(bench.arrive(8)) << bench.health(0).detail;
  EXPECT_EQ(bench.opened, opened + 1);
}

TEST(Axes, IdenticalSimulationsGiveIdenticalPaths) {
  std::vector<std::vector<Joints>> paths;
  for (int run = 0; run < 2; ++run) {
    AxesBench bench;
    bench.faults.set("the-bus", FaultKind::lost, true, 0.05);
    bench.aim = AxesBench::deg(40, -30);
    bench.run(30);
    paths.push_back(bench.path);
  }
  EXPECT_EQ(paths[0], paths[1]);
}

}  // namespace
}  // namespace luxrig
