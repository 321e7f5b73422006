#include "core/calibration/head_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/calibration/random_head.h"

namespace luxrig {
namespace {

TEST(HeadPose, AsStatedIsTheRigFiles) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-2, 2);
  for (int k = 0; k < 100; ++k) {
    HeadPose head;
    head.stated = random_head(random).stated;
    const Joints joints{angle(random), angle(random), 0};
    const Vec3 beam = world_from_lamp(head.stated, joints).direction(-Vec3::UnitZ());
    EXPECT_LT((head.beam_world(joints, {}) - beam).norm(), 1e-12);
  }
}

TEST(HeadPose, HangsUpsideDownByAHalfTurnAboutX) {
  HeadPose head;
  head.upside_down = true;
  EXPECT_LT((head.beam_world({}, {}) - Vec3::UnitZ()).norm(), 1e-12);
  // Tilted towards +Y of the base, which now points to -Y of the room.
  EXPECT_LT((head.beam_world({0, kPi / 2, 0}, {}) + Vec3::UnitY()).norm(), 1e-12);
}

TEST(HeadPose, PlayIsHalfBehindOnEachSide) {
  HeadPose head;
  head.parameters[kHeadTiltPlay] = 0.02;
  for (const int side : {1, -1}) {
    const Vec3 beam = head.beam_world({0, 0.5, 0}, {1, side});
    EXPECT_NEAR(std::atan2(beam.y(), -beam.z()), 0.5 - 0.01 * side, 1e-12);
  }
  // A joint that turns the other way comes from the other side.
  head.parameters[kHeadTiltScale] = -1;
  EXPECT_NEAR(std::atan2(head.beam_world({0, 0.5, 0}, {1, 1}).y(), -head.beam_world({0, 0.5, 0}, {1, 1}).z()), -0.49,
              1e-12);
}

TEST(HeadPose, SendsJointsThatPointThere) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  int reached = 0;
  for (int k = 0; k < 1000; ++k) {
    const HeadPose head = random_head(random);
    const Vec3 direction(normal(random), normal(random), normal(random));
    const Approach from{random() % 2 ? 1 : -1, random() % 2 ? 1 : -1};
    const JointRange range;
    const auto sent = head.joints_towards(direction, from, range, {});
    if (!sent) continue;
    ++reached;
    EXPECT_LT((head.beam_world(*sent, from) - direction.normalized()).norm(), 1e-8);
    EXPECT_LE(std::abs(sent->pan_rad), range.pan_max_rad);
    EXPECT_LE(std::abs(sent->tilt_rad), range.tilt_max_rad);
  }
  EXPECT_GT(reached, 800) << "the range leaves out a cone of 45°, so a seventh of all directions";
}

TEST(HeadPose, SendsNothingOutOfReach) {
  HeadPose head;
  JointRange range;
  range.tilt_min_rad = range.tilt_max_rad = 0;
  EXPECT_FALSE(head.joints_towards(Vec3::UnitX(), {}, range, {}));
  head.parameters[kHeadPanScale] = 0;
  EXPECT_FALSE(head.joints_towards(Vec3::UnitX(), {}, {}, {}));
}

TEST(Rotated, IsARotationAndSmoothAtNone) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const double size : {1.0, 1e-3, 0.9e-6, 1e-9, 0.0}) {
    const Vec3 v = size * Vec3(normal(random), normal(random), normal(random)), a(1, 2, 3);
    const Vec3 by_eigen = v.norm() > 0 ? Vec3(Eigen::AngleAxisd(v.norm(), v.normalized()) * a) : a;
    EXPECT_LT((rotated<double>(v, a) - by_eigen).norm(), 1e-11) << size;
  }
}

}  // namespace
}  // namespace luxrig
