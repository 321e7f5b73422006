#include "core/calibration/head_found.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/core/calibration/random_head.h"

namespace luxrig {
namespace {

/// Motors with play behind them: what a head does, whichever side it comes from.
class HeadWithPlay {
 public:
  explicit HeadWithPlay(const HeadPose& pose) : pose_(pose) {}
  Vec3 beam_after(const Joints& sent) {
    follow(sent.pan_rad * pose_.parameters[kHeadPanScale], pose_.parameters[kHeadPanPlay], lamp_.pan_rad);
    follow(sent.tilt_rad * pose_.parameters[kHeadTiltScale], pose_.parameters[kHeadTiltPlay], lamp_.tilt_rad);
    HeadPose stiff = pose_;
    stiff.parameters[kHeadPanScale] = stiff.parameters[kHeadTiltScale] = 1;
    stiff.parameters[kHeadPanPlay] = stiff.parameters[kHeadTiltPlay] = 0;
    return stiff.beam_world(lamp_, {});
  }

 private:
  static void follow(double motor_rad, double play_rad, double& lamp_rad) {
    lamp_rad = std::clamp(lamp_rad, motor_rad - play_rad / 2, motor_rad + play_rad / 2);
  }
  HeadPose pose_;
  Joints lamp_;
};

Rig rig_of_one_head(const Pose& stated) {
  Rig rig;
  rig.name = "hall";
  rig.luminaires.resize(1);
  rig.luminaires[0].intensity = make_isotropic(1000);
  rig.luminaires[0].lumens = 1000;
  rig.fixtures.resize(1);
  rig.fixtures[0].name = "head";
  rig.fixtures[0].moves = true;
  rig.fixtures[0].pan_speed_rad_s = rig.fixtures[0].tilt_speed_rad_s = 2;
  rig.fixtures[0].world_from_mount = stated;
  return rig;
}

Calibration calibration_of(const HeadPose& pose) {
  HeadFit fit;
  fit.pose = pose;
  fit.covariance *= 1e-6;
  Calibration found;
  found.rig = "hall";
  found.fixtures.resize(1);
  found.fixtures[0].name = "head";
  put_head(fit, found.fixtures[0]);
  return found;
}

TEST(FoundHead, OfACalibratedRigHitsWhatItIsAimedAtWhereverItComesFrom) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  int aims = 0;
  for (int k = 0; k < 300; ++k) {
    const HeadPose pose = random_head(random);
    // Through the file, too.
    const auto read = calibration_from_json(to_json(calibration_of(pose)), "c.json");
    ASSERT_TRUE(read) << read.error().front().text();
    const auto rig = calibrated(rig_of_one_head(pose.stated), *read, "c.json");
    ASSERT_TRUE(rig) << rig.error().front().text();
    const Fixture& fixture = rig->fixtures[0];
    ASSERT_TRUE(fixture.joint_map);
    JointSender sender;
    HeadWithPlay head(pose);
    Joints now;
    Vec3 towards(normal(random), normal(random), normal(random));
    for (int aim = 0; aim < 12; ++aim) {
      // By turns far away, and back by less than the play.
      towards = aim % 3 == 1 ? towards + 0.01 * towards.norm() * Vec3(normal(random), normal(random), normal(random))
                             : Vec3(normal(random), normal(random), normal(random));
      const auto joints = pan_tilt_towards(fixture.world_from_mount, towards, fixture.range, now);
      if (!joints || std::abs(std::sin(joints->tilt_rad)) < std::sin(rad_from_deg(15))) continue;
      now = *joints;
      const Joints sent = sender.send(*fixture.joint_map, now);
      EXPECT_LE(std::abs(sent.pan_rad), fixture.sent_range().pan_max_rad);
      EXPECT_LE(std::abs(sent.tilt_rad), fixture.sent_range().tilt_max_rad);
      EXPECT_LT((head.beam_after(sent) - towards.normalized()).norm(), 1e-7) << k << " " << aim;
      ++aims;
    }
  }
  EXPECT_GT(aims, 2000);
}

// Such as after a start of the daemon: the head stands where the last one left it, and nobody knows from which side it
// came.
TEST(FoundHead, IsHitFromAnyPostureIfItIsSentBesideItFirst) {
  std::mt19937_64 random(15);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1);
  int aims = 0;
  for (int k = 0; k < 300; ++k) {
    const HeadPose pose = random_head(random);
    const auto rig = calibrated(rig_of_one_head(pose.stated), calibration_of(pose), "c.json");
    ASSERT_TRUE(rig);
    const Fixture& fixture = rig->fixtures[0];
    const Vec3 towards(normal(random), normal(random), normal(random));
    const auto joints = pan_tilt_towards(fixture.world_from_mount, towards, fixture.range, {});
    if (!joints || std::abs(std::sin(joints->tilt_rad)) < std::sin(rad_from_deg(15))) continue;
    HeadWithPlay head(pose);
    JointSender sender;
    const Joints aim = sender.send(*fixture.joint_map, *joints);
    // Far away, or within its play.
    const double off_rad = k % 2 ? 1 : 0.01;
    for (int turn = 0; turn < 2; ++turn)
      (void)head.beam_after({aim.pan_rad + off_rad * unit(random), aim.tilt_rad + off_rad * unit(random), 0});
    JointSender next;
    (void)head.beam_after(next.send_beside(*fixture.joint_map, *joints));
    EXPECT_LT((head.beam_after(next.send(*fixture.joint_map, *joints)) - towards.normalized()).norm(), 1e-7) << k;
    ++aims;
  }
  EXPECT_GT(aims, 150);
}

TEST(FoundHead, RestsAndStartsWhereTheSameJointsTakeIt) {
  std::mt19937_64 random(12);
  for (int k = 0; k < 200; ++k) {
    HeadPose pose = random_head(random);
    pose.parameters.segment<2>(kHeadPanPlay).setZero();
    Rig rig = rig_of_one_head(pose.stated);
    rig.fixtures[0].joints = {0.7, -0.9, 0};
    rig.fixtures[0].park = Joints{-1.2, 0.8, 0};
    const auto found = calibrated(rig, calibration_of(pose), "c.json");
    ASSERT_TRUE(found);
    for (const auto& [sent, turned] : {std::pair{rig.fixtures[0].joints, found->fixtures[0].joints},
                                       {*rig.fixtures[0].park, *found->fixtures[0].park}}) {
      const Vec3 beam = found->fixtures[0].world_from_lamp(turned).direction(-Vec3::UnitZ());
      EXPECT_LT((beam - pose.beam_world(sent, {})).norm(), 1e-7);
    }
  }
}

TEST(JointMap, WithoutADifferenceChangesNothing) {
  const JointMap map;
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> angle(-2, 2);
  for (int k = 0; k < 100; ++k) {
    const Joints joints{angle(random), angle(random), 0.1};
    EXPECT_EQ(map.sent_for(joints, {}), joints);
    EXPECT_EQ(map.reached_by(joints, {1, -1}), joints);
  }
}

TEST(JointMap, IsItsOwnInverseFromEachSide) {
  std::mt19937_64 random(14);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 1000; ++k) {
    JointMap map;
    map.pan_scale = (random() % 2 ? 1 : -1) * (1 + 0.2 * unit(random));
    map.tilt_scale = random() % 2 ? 1 : -1;
    map.pan_play_rad = map.tilt_play_rad = 0.02;
    map.askew_x = 0.05 * unit(random);
    map.askew_y = 0.05 * unit(random);
    const Joints sent{3 * unit(random), (random() % 2 ? 1 : -1) * (0.3 + 1.5 * std::abs(unit(random))), 0};
    const Approach from{random() % 2 ? 1 : -1, random() % 2 ? 1 : -1};
    const Joints again = map.sent_for(map.reached_by(sent, from), from);
    EXPECT_NEAR(again.pan_rad, sent.pan_rad, 1e-9);
    EXPECT_NEAR(again.tilt_rad, sent.tilt_rad, 1e-9);
  }
}

TEST(FoundHead, TurnsAsFastAndSettlesAsLateAsWasMeasuredAtLeast) {
  HeadPose pose;
  pose.stated.translation_m = Vec3(1, 2, 3);
  Calibration calibration = calibration_of(pose);
  CalibratedHead& head = *calibration.fixtures[0].head;
  head.pan_speed_deg_s = {100, 5};
  head.tilt_speed_deg_s = {60, 40};
  head.settling_s = {0.7, 0.1};
  const auto rig = calibrated(rig_of_one_head(pose.stated), calibration, "c.json");
  ASSERT_TRUE(rig);
  EXPECT_NEAR(rig->fixtures[0].pan_speed_rad_s, rad_from_deg(90), 1e-9) << "two standard errors less";
  EXPECT_NEAR(rig->fixtures[0].tilt_speed_rad_s, rad_from_deg(18), 1e-9) << "hardly known";
  EXPECT_NEAR(rig->fixtures[0].settles_s, 0.9, 1e-9);
}

}  // namespace
}  // namespace luxrig
