/// Beams against keep-out zones. The exact test is checked against points sampled in the zone, the test of ranges of
/// postures against postures sampled in the range.
#include "core/output/keep_out.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/photometry/beam.h"
#include "tests/random.h"

namespace luxrig {
namespace {

double between_rad(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Least angle to any of many points on the box's surface, refined around the best.
double sampled_angle_to_box_rad(const Vec3& from, const Vec3& direction, const Eigen::AlignedBox3d& box) {
  constexpr int kGrid = 16;
  double best_rad = kPi;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.0, 1.0}) {
      double low_u = 0, high_u = 1, low_v = 0, high_v = 1;
      for (int round = 0; round < 8; ++round) {
        double at_u = 0, at_v = 0, min_rad = 10;
        for (int i = 0; i <= kGrid; ++i) {
          for (int j = 0; j <= kGrid; ++j) {
            Vec3 share;
            share[axis] = side;
            const double u = low_u + (high_u - low_u) * i / kGrid, v = low_v + (high_v - low_v) * j / kGrid;
            share[(axis + 1) % 3] = u;
            share[(axis + 2) % 3] = v;
            const Vec3 point = box.min() + share.cwiseProduct(box.sizes());
            const double angle_rad = between_rad(direction, point - from);
            if (angle_rad < min_rad) min_rad = angle_rad, at_u = u, at_v = v;
          }
        }
        best_rad = std::min(best_rad, min_rad);
        const double half_u = (high_u - low_u) / kGrid * 3, half_v = (high_v - low_v) / kGrid * 3;
        low_u = std::max(0.0, at_u - half_u), high_u = std::min(1.0, at_u + half_u);
        low_v = std::max(0.0, at_v - half_v), high_v = std::min(1.0, at_v + half_v);
      }
    }
  }
  return best_rad;
}

Eigen::AlignedBox3d some_box(Random& random) {
  const Vec3 middle = 5 * random.in_cube();
  const Vec3 half(random.log_between(0.2, 4), random.log_between(0.2, 4), random.log_between(0.2, 4));
  return {middle - half, middle + half};
}

TEST(KeepOut, AngleToABoxIsThatToItsNearestPoint) {
  Random random(3);
  int met = 0, inside = 0, behind = 0;
  for (int i = 0; i < 1500; ++i) {
    const Eigen::AlignedBox3d box = some_box(random);
    const Vec3 from = 5 * random.in_cube(), direction = random.direction();
    const double exact_rad = angle_to_box_rad(from, direction, box);
    if (box.contains(from)) {
      ++inside;
      ASSERT_EQ(exact_rad, 0);
      continue;
    }
    const double sampled_rad = sampled_angle_to_box_rad(from, direction, box);
    met += exact_rad == 0;
    behind += exact_rad > kPi / 2;
    ASSERT_LE(exact_rad, sampled_rad + 1e-9) << i;
    ASSERT_GE(exact_rad, sampled_rad - 2e-4) << i;
  }
  EXPECT_GT(met, 25);
  EXPECT_GT(inside, 5);
  EXPECT_GT(behind, 50);
}

TEST(KeepOut, AngleToABallIsThatToItsOutline) {
  // A ball of 1 m radius seen from 2 m away is 30° to each side.
  EXPECT_NEAR(angle_to_ball_rad({0, 0, 0}, Vec3::UnitY(), {2, 0, 0}, 1), rad_from_deg(60), 1e-12);
  EXPECT_NEAR(angle_to_ball_rad({0, 0, 0}, -Vec3::UnitX(), {2, 0, 0}, 1), rad_from_deg(150), 1e-12);
  EXPECT_EQ(angle_to_ball_rad({0, 0, 0}, Vec3::UnitX(), {2, 0, 0}, 1), 0);
  EXPECT_EQ(angle_to_ball_rad({1.5, 0, 0}, Vec3::UnitZ(), {2, 0, 0}, 1), 0);
}

/// A spot of 10° beam and 20° field, 4 m up, free to turn in every direction.
Rig rig_with(const KeepOut& zone, const Mat3& mount = Mat3::Identity()) {
  Rig rig;
  rig.luminaires.emplace_back();
  Luminaire& spot = rig.luminaires.back();
  spot.model = LuminaireModel::spot;
  spot.beam_angle_rad = rad_from_deg(10);
  spot.field_angle_rad = rad_from_deg(20);
  spot.intensity = make_spot(1000, spot.beam_angle_rad, spot.field_angle_rad);
  rig.fixtures.emplace_back();
  rig.fixtures.back().moves = true;
  rig.fixtures.back().world_from_mount = {mount, Vec3(0, 0, 4)};
  rig.fixtures.emplace_back();  // a fixture without a zone
  rig.keep_outs = {zone};
  rig.keep_outs.back().heads = {0};
  return rig;
}

KeepOut ball(const Vec3& centre_m, double radius_m, double margin_deg = 0) {
  KeepOut zone;
  zone.name = "ball";
  zone.centre_world_m = centre_m;
  zone.radius_m = radius_m;
  zone.margin_rad = rad_from_deg(margin_deg);
  return zone;
}

TEST(KeepOut, ABeamReachesToItsFieldAngleZoomAndMargin) {
  // Nearly a point, straight below.
  const KeepOutZones zones(rig_with(ball({0, 0, 0}, 1e-9, 3)));
  const auto at = [](double tilt_deg, double beam_deg) {
    return Joints{0, rad_from_deg(tilt_deg), rad_from_deg(beam_deg)};
  };
  EXPECT_TRUE(zones.met(0, at(12.99, 0)));
  EXPECT_FALSE(zones.met(0, at(13.01, 0)));
  EXPECT_TRUE(zones.met(0, at(22.99, 20)));  // twice the beam, twice the field
  EXPECT_FALSE(zones.met(0, at(23.01, 20)));
  EXPECT_FALSE(zones.met(0, at(8.01, 5)));
  EXPECT_TRUE(zones.met(0, at(7.99, 5)));
  EXPECT_FALSE(zones.met(1, at(0, 0)));
  EXPECT_EQ(zones.heads().size(), 1u);
}

TEST(KeepOut, AMeasuredBeamReachesToATenthOfItsPeak) {
  Luminaire luminaire;
  luminaire.model = LuminaireModel::ies;
  luminaire.intensity = make_spot(500, rad_from_deg(20), rad_from_deg(37));
  EXPECT_NEAR(field_half_angle_rad(luminaire, 0), rad_from_deg(18.5), rad_from_deg(0.51));
  EXPECT_GE(field_half_angle_rad(luminaire, 0), rad_from_deg(18.5));
  luminaire.intensity = make_isotropic(500);
  EXPECT_NEAR(field_half_angle_rad(luminaire, 0), kPi, 1e-12);
  luminaire.intensity = make_lambertian(500);
  EXPECT_GE(field_half_angle_rad(luminaire, 0), std::acos(0.1));
}

TEST(KeepOut, AnIsotropicLampMeetsEveryZone) {
  Rig rig = rig_with(ball({0, 0, 50}, 0.1));
  rig.luminaires[0].model = LuminaireModel::isotropic;
  rig.luminaires[0].intensity = make_isotropic(500);
  EXPECT_TRUE(KeepOutZones(rig).met(0, {}));
}

/// Ranges of postures: no sampled posture in the zone is missed, and false alarms are near the zone.
TEST(KeepOut, MissesNoPostureOfARange) {
  Random random(5);
  int clear = 0, met = 0, near = 0;
  for (int i = 0; i < 400; ++i) {
    KeepOut zone = ball(Vec3(0, 0, 4) + 3 * random.in_cube(), random.log_between(0.1, 2), random.between(0, 5));
    if (i % 2 == 0) zone.box_world_m = some_box(random);
    const Rig rig = rig_with(zone, random.rotation());
    const KeepOutZones zones(rig);
    KeepOut wider = zone;
    wider.margin_rad += 2 * kSweepSlack_rad;
    const KeepOutZones generous(rig_with(wider, rig.fixtures[0].world_from_mount.rotation));
    const double pan = random.between(-4, 4), tilt = random.between(-2, 2);
    const double pan_way = random.log_between(0.01, 2), tilt_way = random.log_between(0.01, 1);
    const JointBox range{{pan, tilt, 0.05}, {pan + pan_way, tilt + tilt_way, 0.2}};
    const bool reported = zones.may_meet(0, range).has_value();
    bool found = false, found_near = false;
    constexpr int kSteps = 40;
    for (int a = 0; a <= kSteps && !found; ++a) {
      for (int b = 0; b <= kSteps && !found; ++b) {
        const Joints at{pan + pan_way * a / kSteps, tilt + tilt_way * b / kSteps, 0.2};
        found = zones.met(0, at).has_value();
        found_near = found_near || generous.met(0, at).has_value();
      }
    }
    ASSERT_TRUE(!found || reported) << i;
    ASSERT_TRUE(!reported || found || found_near) << i;
    clear += !reported;
    met += found;
    near += reported && !found;
  }
  EXPECT_GT(clear, 60);
  EXPECT_GT(met, 40);
  EXPECT_LT(near, 40);
}

TEST(KeepOut, MissesNoPostureOnStraightJointLines) {
  Random random(6);
  int clear = 0, met = 0, spared = 0;
  for (int i = 0; i < 400; ++i) {
    const Rig rig = rig_with(ball(4 * random.in_cube(), random.log_between(0.05, 1), 1));
    const KeepOutZones zones(rig);
    const double pan = random.between(-3, 3), tilt = random.between(-2, 2);
    const JointBox from{{pan, tilt, 0}, {pan + 0.05, tilt + 0.03, 0}};
    const Joints to{random.between(-3, 3), random.between(-2, 2), 0};
    const bool reported = zones.may_meet_on_line(0, from, to).has_value();
    bool found = false;
    for (int k = 0; k < 4000 && !found; ++k) {
      const double share = random.between(0, 1), a = pan + random.between(0, 0.05), b = tilt + random.between(0, 0.03);
      found = zones.met(0, {a + (to.pan_rad - a) * share, b + (to.tilt_rad - b) * share, 0}).has_value();
    }
    ASSERT_TRUE(!found || reported) << i;
    clear += !reported;
    met += found;
    spared += !reported && zones.may_meet(0, from.joined(JointBox::at(to))).has_value();
  }
  EXPECT_GT(clear, 50);
  EXPECT_GT(met, 50);
  EXPECT_GT(spared, 20) << "a line passes where the joints turned each by itself may not";
}

}  // namespace
}  // namespace luxrig
