/// No lit beam meets a keep-out zone, however a desk turns a head, and wherever the head may be on its way.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "core/output/head_travel.h"
#include "core/output/keep_out.h"
#include "core/show/show_controller.h"
#include "tests/core/output/at.h"
#include "tests/random.h"

namespace luxrig {
namespace {

/// A head 4 m above a stage, with a zone to one side of it, and a fixed lamp. No meters.
Rig stage() {
  Rig rig;
  rig.name = "stage";
  rig.buses.resize(1);
  rig.buses[0].name = "dmx";
  rig.luminaires.emplace_back();
  Luminaire& spot = rig.luminaires.back();
  spot.model = LuminaireModel::spot;
  spot.beam_angle_rad = rad_from_deg(8);
  spot.field_angle_rad = rad_from_deg(14);
  spot.intensity = make_spot(1000, spot.beam_angle_rad, spot.field_angle_rad);
  for (const char* name : {"head", "lamp"}) {
    rig.fixtures.emplace_back();
    rig.fixtures.back().name = name;
    rig.fixtures.back().world_from_mount.translation_m = Vec3(0, 0, 4);
  }
  Fixture& head = rig.fixtures[0];
  head.moves = true;
  head.range = {-3, 3, -1.5, 1.5};
  head.pan_speed_rad_s = 3;
  head.tilt_speed_rad_s = 2;
  head.park = Joints{0, 1.4, 0};
  rig.keep_outs.emplace_back();
  rig.keep_outs[0].name = "audience";
  rig.keep_outs[0].box_world_m = Eigen::AlignedBox3d(Vec3(1.5, -2, 0), Vec3(5, 2, 1.5));
  rig.keep_outs[0].heads = {0};
  rig.control.fade_s = 1;
  rig.safe.hold_s = 1;
  return rig;
}

constexpr double kTowardsTheZone_rad = -kPi / 2;  // of pan: towards +x

/// The rig with a true head: obeys after a delay, each joint at its own speed, the stated one or faster.
struct Stage {
  Rig rig;
  KeepOutZones zones;
  ShowController show;
  double now_s = 0, delay_s = 0.3, speed = 1;
  Joints truth{2, -1, 0};
  std::deque<std::pair<double, Joints>> told;
  double lit_s = 0, lit_while_turning_s = 0, in_zone_s = 0;
  DeskFrame frame;

  explicit Stage(const Rig& rig_in) : rig(rig_in), zones(rig), show(rig, LightModel{}) {}

  void desk(double drive, const Joints& joints) { frame = {DeskPresence::present, {{0, drive, joints}}, "desk"}; }
  [[nodiscard]] double level() const {
    std::vector<double> level(2);
    show.program().levels_at(at(now_s), level);
    return level[0];
  }
  [[nodiscard]] Joints asked() const {
    std::vector<Joints> joints(2);
    show.program().joints_at(at(now_s), joints);
    return joints[0];
  }
  /// Output and head motion every 5 ms; the show every 20 ms.
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 200)); ++i) {
      now_s += 0.005;
      if (i % 4 == 0) {
        if (!frame.commands.empty()) show.desk(at(now_s), 0, frame);
        show.step(at(now_s));
      }
      told.push_back({now_s, asked()});
      while (told.size() > 1 && told[1].first <= now_s - delay_s) told.pop_front();
      const Joints before = truth;
      if (told.front().first <= now_s - delay_s) {
        const auto go = [](double from, double to, double way) { return from + std::clamp(to - from, -way, way); };
        truth.pan_rad = go(truth.pan_rad, told.front().second.pan_rad, 0.005 * rig.fixtures[0].pan_speed_rad_s * speed);
        truth.tilt_rad =
            go(truth.tilt_rad, told.front().second.tilt_rad, 0.005 * rig.fixtures[0].tilt_speed_rad_s * speed);
      }
      const bool in_zone = zones.met(0, truth).has_value();
      ASSERT_FALSE(in_zone && level() > 0) << now_s << " s, level " << level();
      in_zone_s += in_zone ? 0.005 : 0;
      lit_s += level() > 0 ? 0.005 : 0;
      lit_while_turning_s += level() > 0 && !(truth == before) ? 0.005 : 0;
    }
  }
};

TEST(ShowKeepOut, NoLitBeamMeetsTheZoneHoweverADeskTurnsIt) {
  Random random(21);
  double lit_s = 0, lit_while_turning_s = 0, in_zone_s = 0;
  for (int run = 0; run < 12; ++run) {
    Stage small(stage());
    small.delay_s = random.between(0, 0.45);
    small.speed = random.log_between(1, 5);
    const DeskMode mode = run % 2 == 0 ? DeskMode::takeover : DeskMode::merge;
    ASSERT_EQ(small.show.add_desk({mode, run % 3 == 0 ? HandBack::fade : HandBack::at_once}, {"desk", {0}}), 0u);
    if (mode == DeskMode::merge) small.show.apply(at(0), std::vector<double>{0.5, 0.5});
    Joints wanted{2, 0.8, 0};
    for (int i = 0; i < 60; ++i) {
      const bool sweeps = random.below(3) == 0;
      const Joints next{random.between(-3, 3), random.between(-1.5, 1.5), 0};
      for (int k = 1; k <= 20; ++k) {
        const double share = sweeps ? k / 20.0 : 1.0;  // a desk that turns it step by step, or at once
        small.desk(random.between(0.3, 1), {wanted.pan_rad + (next.pan_rad - wanted.pan_rad) * share,
                                            wanted.tilt_rad + (next.tilt_rad - wanted.tilt_rad) * share, 0});
        small.run(0.04);
        ASSERT_FALSE(testing::Test::HasFatalFailure()) << run;
      }
      wanted = next;
      small.run(random.between(0, 3));
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << run;
    }
    lit_s += small.lit_s;
    lit_while_turning_s += small.lit_while_turning_s;
    in_zone_s += small.in_zone_s;
  }
  // It is not simply dark, and it does cross the zone.
  EXPECT_GT(lit_s, 300);
  EXPECT_GT(lit_while_turning_s, 50);
  EXPECT_GT(in_zone_s, 20);
}

TEST(ShowKeepOut, AHeadGoesDarkBeforeCrossingAZoneAndIsRelitAfterwards) {
  Stage small(stage());
  ASSERT_EQ(small.show.add_desk({DeskMode::takeover, HandBack::at_once}, {"desk", {0}}), 0u);
  const Joints one{kTowardsTheZone_rad + 1.3, 1, 0}, other{kTowardsTheZone_rad - 1.3, 1, 0};
  small.desk(1, one);
  small.run(6);
  ASSERT_EQ(small.level(), 1);
  ASSERT_EQ(small.asked(), one);
  small.desk(1, other);  // straight through
  small.run(0.1);
  EXPECT_EQ(small.asked(), one);  // still held, and on the way to dark
  EXPECT_GT(small.level(), 0);
  EXPECT_LT(small.level(), 1);
  small.run(0.15);
  EXPECT_EQ(small.level(), 0);
  EXPECT_TRUE(small.show.status(at(small.now_s)).fixtures[0].kept_dark);
  EXPECT_EQ(small.show.status(at(small.now_s)).fixtures[0].waits_for.find("its beam to be clear of keep-out zone \""),
            0u);
  small.run(0.15);
  EXPECT_EQ(small.asked(), other);
  // 2.6 rad at 3 rad/s, plus half a second, plus the fade back to light.
  small.run(1.0);
  EXPECT_EQ(small.level(), 0);
  small.run(1.0);
  EXPECT_EQ(small.level(), 1);
  EXPECT_FALSE(small.show.status(at(small.now_s)).fixtures[0].kept_dark);
  EXPECT_EQ(small.show.status(at(small.now_s)).fixtures[0].waits_for, "");
}

TEST(ShowKeepOut, AMoveThatMissesTheZoneStaysLit) {
  Stage small(stage());
  ASSERT_EQ(small.show.add_desk({DeskMode::takeover, HandBack::at_once}, {"desk", {0}}), 0u);
  small.desk(1, {kTowardsTheZone_rad + 1.6, 1, 0});
  small.run(6);
  small.desk(1, {kTowardsTheZone_rad + 3, 0.4, 0});
  for (int i = 0; i < 100; ++i) {
    small.run(0.02);
    ASSERT_EQ(small.level(), 1) << i;
  }
}

TEST(ShowKeepOut, AHeadTurnedIntoAZoneByADeskStaysDarkWithAnAlarm) {
  Stage small(stage());
  ASSERT_EQ(small.show.add_desk({DeskMode::takeover, HandBack::at_once}, {"desk", {0}}), 0u);
  small.desk(1, {kTowardsTheZone_rad, 0.8, 0});
  small.run(10);
  EXPECT_EQ(small.level(), 0);
  const ShowStatus status = small.show.status(at(small.now_s));
  ASSERT_EQ(status.alarms.size(), 1u);
  EXPECT_EQ(status.alarms[0].text, "head looks into keep-out zone \"audience\" and stays dark; turn it elsewhere");
  EXPECT_EQ(status.fixtures[0].waits_for, "another aim: it looks into keep-out zone \"audience\"");
  EXPECT_FALSE(small.show.identify(at(small.now_s), 0, from_seconds(1)));
}

TEST(ShowKeepOut, OwnMovesStayDarkAndTheSafeLookLightsNoZone) {
  Stage small(stage());
  small.show.apply(at(0), std::vector<double>{0.6, 0.6});  // straight down
  small.run(8);
  ASSERT_EQ(small.level(), 0.6);
  Look look;
  look.joints = {{kTowardsTheZone_rad, 0.8, 0}, {}};
  look.levels = {0.6, 0.6};
  small.show.apply(at(small.now_s), look, {});  // no plan may, but nothing depends on that
  small.run(8);
  EXPECT_EQ(small.level(), 0);
  EXPECT_EQ(small.show.safe_look(at(small.now_s))[0], 0);
  EXPECT_GT(small.show.safe_look(at(small.now_s))[1], 0);
  small.show.go_safe(at(small.now_s));
  small.run(6);
  EXPECT_EQ(small.level(), 0);
}

TEST(ShowKeepOut, IdentifyBlinksInsteadOfNoddingIntoTheZone) {
  for (const bool near : {false, true}) {
    Rig rig = stage();
    // The edge of the zone is some degrees further on.
    rig.fixtures[0].joints = {near ? kTowardsTheZone_rad : kTowardsTheZone_rad + kPi, near ? 0.2 : 0.8, 0};
    Stage small(rig);
    const KeepOutZones zones(rig);
    ASSERT_FALSE(zones.met(0, rig.fixtures[0].joints));
    ASSERT_TRUE(!near || zones.met(0, {kTowardsTheZone_rad, 0.2 + rad_from_deg(5), 0}));
    small.show.apply(at(0), std::vector<double>{0.6, 0.6});
    small.run(8);
    ASSERT_TRUE(small.show.identify(at(small.now_s), 0, from_seconds(3)));
    bool dark = false, turned = false;
    for (int i = 0; i < 100; ++i) {
      small.run(0.02);
      dark = dark || small.level() == 0;
      turned = turned || !(small.asked() == rig.fixtures[0].joints);
    }
    EXPECT_EQ(dark, near);
    EXPECT_EQ(turned, !near);
  }
}

TEST(ShowKeepOut, AnUnresponsiveHeadIsNotAssumedToHaveArrived) {
  Stage small(stage());
  ASSERT_EQ(small.show.add_desk({DeskMode::takeover, HandBack::at_once}, {"desk", {0}}), 0u);
  const std::vector<Health> dead = {{"dmx", Life::faulted, "", {}, {}}}, well = {{"dmx", Life::active, "", {}, {}}};
  small.show.health(at(0), dead);
  small.desk(1, {kTowardsTheZone_rad + 1.5, 1, 0});
  small.run(10);
  EXPECT_EQ(small.level(), 0);
  small.show.health(at(small.now_s), well);
  small.run(6);
  EXPECT_EQ(small.level(), 1);
}

}  // namespace
}  // namespace luxrig
