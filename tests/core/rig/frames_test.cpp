#include "core/rig/frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace luxrig {
namespace {

constexpr double kTight_rad = 1e-9;

Joints joints_deg(double pan_deg, double tilt_deg) { return {rad_from_deg(pan_deg), rad_from_deg(tilt_deg)}; }

Vec3 beam_world(const Pose& world_from_mount, const Joints& joints) {
  return world_from_lamp(world_from_mount, joints).direction(-Vec3::UnitZ());
}

/// 16-bit value of an angle within its travel, as in a pair of DMX slots.
int dmx16(double angle_rad, double min_rad, double max_rad) {
  return static_cast<int>(std::lround((angle_rad - min_rad) / (max_rad - min_rad) * 65535));
}

Pose random_mount(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return {q.normalized().toRotationMatrix(), Vec3(normal(random), normal(random), normal(random)) * 10};
}

TEST(Frames, BeamFollowsTheDocumentedFormula) {
  for (double pan = -3; pan < 3; pan += 0.37) {
    for (double tilt = -2; tilt < 2; tilt += 0.29) {
      const Vec3 expected(-std::sin(pan) * std::sin(tilt), std::cos(pan) * std::sin(tilt), -std::cos(tilt));
      EXPECT_LT((beam_world({}, {pan, tilt}) - expected).norm(), 1e-14);
    }
  }
}

TEST(Frames, RollTurnsTheLampAboutItsBeamOnly) {
  const Pose straight = world_from_lamp({}, joints_deg(20, 30), 0), rolled = world_from_lamp({}, joints_deg(20, 30), 1);
  EXPECT_LT((straight.direction(-Vec3::UnitZ()) - rolled.direction(-Vec3::UnitZ())).norm(), 1e-14);
  EXPECT_NEAR(straight.direction(Vec3::UnitX()).dot(rolled.direction(Vec3::UnitX())), std::cos(1.0), 1e-14);
}

// The aim vectors of the protocol notes: mount = identity, pan ±270°, tilt ±135°.
TEST(SameAim, HoldsThroughTwelveDigitsAndNotForAThousandthOfADegree) {
  const Joints at{1.2345678901234567, -0.76543210987654321, 0.3};
  Joints other = at;
  EXPECT_TRUE(same_aim(at, other));
  other.pan_rad += rad_from_deg(1e-10);  // the last of twelve digits
  EXPECT_TRUE(same_aim(at, other));
  for (double Joints::*joint : {&Joints::pan_rad, &Joints::tilt_rad, &Joints::beam_rad}) {
    other = at;
    other.*joint += rad_from_deg(0.001);
    EXPECT_FALSE(same_aim(at, other));
    other.*joint = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(same_aim(at, other)) << "what is no number is no aim";
  }
}

TEST(PanTiltTowards, MeetsTheTestVectors) {
  const JointRange range;
  const auto raw = [&](const Joints& j) {
    return std::pair(dmx16(j.pan_rad, range.pan_min_rad, range.pan_max_rad),
                     dmx16(j.tilt_rad, range.tilt_min_rad, range.tilt_max_rad));
  };
  const auto forward = pan_tilt_towards({}, Vec3::UnitY(), range, {});
  ASSERT_TRUE(forward);
  EXPECT_EQ(raw(*forward), std::pair(0x8000, 0xD555));

  const auto right = pan_tilt_towards({}, Vec3::UnitX(), range, joints_deg(-60, 45));
  ASSERT_TRUE(right);
  EXPECT_EQ(raw(*right), std::pair(0x5555, 0xD555));
  const auto right_flipped = pan_tilt_towards({}, Vec3::UnitX(), range, joints_deg(60, -45));
  ASSERT_TRUE(right_flipped);
  EXPECT_EQ(raw(*right_flipped), std::pair(0xAAAA, 0x2AAB));

  const auto down = pan_tilt_towards({}, -Vec3::UnitZ(), range, joints_deg(77, 20));
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->pan_rad, rad_from_deg(77), kTight_rad);
  EXPECT_EQ(raw(*down).second, 0x8000);
}

TEST(PanTiltTowards, DoesNotFlipOnATie) {
  // From the middle, both postures for +X need a quarter turn of each joint.
  const auto from_middle = pan_tilt_towards({}, Vec3::UnitX(), {}, {});
  ASSERT_TRUE(from_middle);
  EXPECT_NEAR(from_middle->pan_rad, rad_from_deg(-90), kTight_rad);
  EXPECT_NEAR(from_middle->tilt_rad, rad_from_deg(90), kTight_rad);
}

TEST(PanTiltTowards, PointsAsAskedFromAnyMount) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-200, 200);
  const JointRange all_round{-kPi, kPi, -kPi, kPi};
  for (int i = 0; i < 2000; ++i) {
    const Pose mount = random_mount(random);
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Joints from{normal(random), normal(random)};
    const auto joints = pan_tilt_towards(mount, direction * std::pow(10, exponent(random)), all_round, from);
    ASSERT_TRUE(joints);
    EXPECT_LT((beam_world(mount, *joints) - direction).norm(), 1e-9);
  }
}

/// All postures within range, by trying every image: the independent reference.
std::vector<Joints> all_postures(const Vec3& d, const JointRange& range) {
  std::vector<Joints> out;
  const double tilt = std::acos(std::clamp(-d.z(), -1.0, 1.0)), pan = std::atan2(-d.x(), d.y());
  for (int flip = 0; flip < 2; ++flip) {
    for (int p = -3; p <= 3; ++p) {
      for (int t = -3; t <= 3; ++t) {
        const Joints j{pan + flip * kPi + p * 2 * kPi, (flip ? -tilt : tilt) + t * 2 * kPi};
        if (j.pan_rad >= range.pan_min_rad && j.pan_rad <= range.pan_max_rad && j.tilt_rad >= range.tilt_min_rad &&
            j.tilt_rad <= range.tilt_max_rad) {
          out.push_back(j);
        }
      }
    }
  }
  return out;
}

TEST(PanTiltTowards, TakesTheNearestOfAllPosturesAndImages) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(-5, 5);
  int reached = 0, unreachable = 0;
  for (int i = 0; i < 5000; ++i) {
    JointRange range{angle(random), angle(random), angle(random), angle(random)};
    if (range.pan_min_rad > range.pan_max_rad) std::swap(range.pan_min_rad, range.pan_max_rad);
    if (range.tilt_min_rad > range.tilt_max_rad) std::swap(range.tilt_min_rad, range.tilt_max_rad);
    const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Joints from{angle(random), angle(random)};
    const auto got = pan_tilt_towards({}, d, range, from);
    const auto postures = all_postures(d, range);
    ASSERT_EQ(got.has_value(), !postures.empty());
    if (!got) {
      ++unreachable;
      continue;
    }
    ++reached;
    const auto move = [&](const Joints& j) {
      return std::max(std::abs(j.pan_rad - from.pan_rad), std::abs(j.tilt_rad - from.tilt_rad));
    };
    double least = std::numeric_limits<double>::infinity();
    for (const Joints& j : postures) least = std::min(least, move(j));
    EXPECT_NEAR(move(*got), least, 1e-7);
    EXPECT_LT((beam_world({}, *got) - d).norm(), 1e-7);
    EXPECT_GE(got->pan_rad, range.pan_min_rad);
    EXPECT_LE(got->pan_rad, range.pan_max_rad);
    EXPECT_GE(got->tilt_rad, range.tilt_min_rad);
    EXPECT_LE(got->tilt_rad, range.tilt_max_rad);
  }
  EXPECT_GT(reached, 1000);
  EXPECT_GT(unreachable, 100);
}

TEST(PanTiltTowards, KeepsTurningInsteadOfUnwindingWhenTheTravelAllows) {
  // At pan 260°, a head with more travel goes on to 280° when asked for pan -80° (= 280°).
  const JointRange wide{rad_from_deg(-360), rad_from_deg(360), rad_from_deg(-135), rad_from_deg(135)};
  const Vec3 d = beam_world({}, joints_deg(-80, 60));
  const auto joints = pan_tilt_towards({}, d, wide, joints_deg(260, 60));
  ASSERT_TRUE(joints);
  EXPECT_NEAR(joints->pan_rad, rad_from_deg(280), kTight_rad);
}

TEST(PanTiltTowards, ReachesTheStopOfAJoint) {
  const JointRange range{rad_from_deg(-90), rad_from_deg(90), 0, rad_from_deg(90)};
  for (const double pan_deg : {-90.0, 90.0}) {
    const auto joints = pan_tilt_towards({}, beam_world({}, joints_deg(pan_deg, 90)), range, {});
    ASSERT_TRUE(joints);
    EXPECT_NEAR(joints->pan_rad, rad_from_deg(pan_deg), kTight_rad);
    EXPECT_LE(joints->tilt_rad, range.tilt_max_rad);
  }
}

TEST(PanTiltTowards, StraightDownFromOutsideTheTravelGoesToItsNearestStop) {
  const auto joints = pan_tilt_towards({}, -Vec3::UnitZ(), {-1, 1, -1, 1}, {2, 0});
  ASSERT_TRUE(joints);
  EXPECT_EQ(joints->pan_rad, 1);
}

TEST(PanTiltTowards, ReportsADirectionOutOfReach) {
  EXPECT_FALSE(pan_tilt_towards({}, Vec3::UnitZ(), {}, {}));  // straight up: tilt 180° of 135°
  EXPECT_FALSE(pan_tilt_towards({}, -Vec3::UnitZ(), {-1, 1, 0.5, 1}, {}));
  EXPECT_FALSE(pan_tilt_towards({}, Vec3::UnitY(), {1, -1, -2, 2}, {}));  // an inverted range holds nothing
}

TEST(PanTiltTowardsDeathTest, AbortsOnAnInvalidDirection) {
  EXPECT_DEATH((void)pan_tilt_towards({}, Vec3::Zero(), {}, {}), "no direction");
  EXPECT_DEATH((void)pan_tilt_towards({}, Vec3::Constant(std::nan("")), {}, {}), "no direction");
}

}  // namespace
}  // namespace luxrig
