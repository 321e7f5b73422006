/// Heads of a rig whose points have limits may be turned by hand: wherever they look, and however they truly hang, no
/// limit is exceeded.
#include "core/tasks/any_aim.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <deque>

#include "core/output/dimming.h"
#include "core/rig/joint_map.h"
#include "core/show/show_controller.h"
#include "core/transport/evaluator.h"
#include "tests/core/output/at.h"
#include "tests/random.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

/// A head and a fixed lamp 3 m above three places with limits.
Rig rig_with_limits() {
  Rig rig;
  rig.name = "limits";
  rig.buses.resize(1);
  rig.buses[0].name = "dmx";
  rig.luminaires.emplace_back();
  Luminaire& spot = rig.luminaires.back();
  spot.model = LuminaireModel::spot;
  spot.beam_angle_rad = rad_from_deg(12);
  spot.field_angle_rad = rad_from_deg(20);
  spot.intensity = make_spot(1000, spot.beam_angle_rad, spot.field_angle_rad);
  for (const char* name : {"head", "lamp"}) {
    rig.fixtures.emplace_back();
    rig.fixtures.back().name = name;
    rig.fixtures.back().world_from_mount.translation_m = Vec3(0, 0, 1.5);
  }
  Fixture& head = rig.fixtures[0];
  head.moves = true;
  head.range = {-3, 3, -2, 2};
  head.pan_speed_rad_s = 2;
  head.tilt_speed_rad_s = 0.7;
  for (const Vec3& at_m : {Vec3(1, 0.4, -1.5), Vec3(-0.8, 1, -1.5), Vec3(0.1, -1.2, -1.5)}) {
    Point point;
    point.name = "place";
    point.position_world_m = at_m;
    point.normal_world = Vec3::UnitZ();
    point.max_lx = 60;
    rig.points.push_back(point);
  }
  rig.control.fade_s = 1;
  rig.safe.hold_s = 1;
  return rig;
}

/// The head as it truly is, and what it truly gives.
struct TrueHead {
  Pose hangs;
  double pan_way = 1, power = 1, gain = 1, delay_s = 0.3, speed = 1;
  Joints at;
  std::deque<std::pair<double, Joints>> told;

  TrueHead(const Rig& rig, Random& random) {
    const Fixture& head = rig.fixtures[0];
    const Vec3 about = Vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)).normalized();
    const Mat3 turn = Eigen::AngleAxisd(rad_from_deg(5), about).toRotationMatrix();
    hangs = {turn * head.world_from_mount.rotation,
             head.world_from_mount.translation_m + kHangsOff_m * Vec3(about.y(), about.z(), about.x()).normalized()};
    if (random.below(3) == 0) hangs.rotation = hangs.rotation * Vec3(1, -1, -1).asDiagonal();
    if (random.below(3) == 0) pan_way = -1;
    power = random.between(0.8, 2.4);
    gain = random.between(0.8, rig.control.gain_max);
    delay_s = random.between(0, 0.45);
    speed = random.log_between(1, 4);
  }
  void step(double now_s, const Joints& asked, const Fixture& stated) {
    told.push_back({now_s, asked});
    while (told.size() > 1 && told[1].first <= now_s - delay_s) told.pop_front();
    if (told.front().first > now_s - delay_s) return;
    const auto go = [](double from, double to, double way) { return from + std::clamp(to - from, -way, way); };
    at.pan_rad = go(at.pan_rad, told.front().second.pan_rad, 0.005 * stated.pan_speed_rad_s * speed);
    at.tilt_rad = go(at.tilt_rad, told.front().second.tilt_rad, 0.005 * stated.tilt_speed_rad_s * speed);
  }
  [[nodiscard]] double lux(const Rig& rig, double level, const Point& point) const {
    const Pose lamp = world_from_lamp(hangs, {pan_way * at.pan_rad, at.tilt_rad, 0}, 0);
    const Vec3 to_m = point.position_world_m - lamp.translation_m;
    const double share = std::pow(drive_from_level(rig.fixtures[0].dimmer_curve, level), power);
    return gain * share * rig.luminaires[0].intensity->intensity_cd(lamp.inverse_direction(to_m.normalized())) *
           std::max(0.0, -to_m.normalized().dot(point.normal_world)) / to_m.squaredNorm();
  }
};

TEST(AnyAim, NoLimitIsExceededWhileAHeadIsTurnedByHandHoweverItHangs) {
  Random random(7);
  double brightest_share = 0;
  for (int run = 0; run < 16; ++run) {
    Rig rig = rig_with_limits();
    rig.fixtures[0].dimmer_curve = run % 2 == 0 ? DimmerCurve::linear : DimmerCurve::square;
    TrueHead head(rig, random);
    if (run < 8) {  // as bright as is allowed
      head.power = 0.8;
      head.gain = rig.control.gain_max;
      head.speed = 1;
    }
    LightModel model;
    // At its own aim, the head lights none of the places; the lamp lights them up to half their limit.
    model.point_lux_per_level = Eigen::MatrixXd::Zero(3, 2);
    model.point_lux_per_level.col(1).setConstant(40);
    model.any_aim_lux_per_level = any_aim_lux_per_level(rig, {});
    const std::vector<Joints> own{{0, 1.9, 0}, {}};
    ShowController show(rig, model, own);
    ASSERT_FALSE(show.aim(at(0), 0, {0.2, 0.3, 0}, 1, from_seconds(5))) << "nothing is lit";
    Look look = hung_look(rig);
    look.joints = own;
    look.levels = {0.9, 0.7};
    look.goal_lx.resize(rig.points.size());
    show.apply(at(0), look, model);
    double now_s = 0, lit_while_aimed_s = 0;
    const auto run_for = [&](double seconds) {
      for (int i = 0; i < static_cast<int>(std::lround(seconds * 200)); ++i) {
        now_s += 0.005;
        if (i % 4 == 0) show.step(at(now_s));
        std::vector<double> level(2);
        std::vector<Joints> joints(2);
        show.program().levels_at(at(now_s), level);
        show.program().joints_at(at(now_s), joints);
        head.step(now_s, joints[0], rig.fixtures[0]);
        lit_while_aimed_s += level[0] > 0 && level[0] < 0.9 ? 0.005 : 0;
        for (const Point& point : rig.points) {
          const double lux = head.lux(rig, level[0], point) + 40 * level[1];
          ASSERT_LE(lux, *point.max_lx) << now_s << " s, level " << level[0] << " and " << level[1];
          brightest_share = std::max(brightest_share, head.lux(rig, level[0], point) / *point.max_lx);
        }
      }
    };
    run_for(12);
    for (int k = 0; k < 12; ++k) {
      // Half of the aims are at the places, as the rig file has them.
      const auto towards =
          pan_tilt_towards(rig.fixtures[0].world_from_mount,
                           rig.points[random.below(3)].position_world_m - Vec3(0, 0, 1.5), rig.fixtures[0].range, {});
      ASSERT_TRUE(towards);
      Joints aim = k % 2 == 0 ? *towards : Joints{random.between(-3, 3), random.between(-2, 2), 0};
      if (k % 3 == 0) aim = {random.between(-0.1, 0.1), -1.6, 0};  // it passes the third place on its way back
      ASSERT_TRUE(show.aim(at(now_s), 0, aim, random.below(4) == 0 ? 0 : 1, from_seconds(random.between(0.5, 4))));
      run_for(k % 3 == 0 ? 9 : random.between(0.2, 5));
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << run;
    }
    EXPECT_GT(lit_while_aimed_s, 1) << run;
    run_for(15);
    std::vector<double> level(2);
    show.program().levels_at(at(now_s), level);
    EXPECT_NEAR(level[0], 0.9, 1e-9) << "its light is back";
    EXPECT_TRUE(show.program().turned.empty());
  }
  EXPECT_GT(brightest_share, 0.1) << "its beam met a place";
}

TEST(AnyAim, WithoutABoundOnItsLightAHeadIsNotTurned) {
  const Rig rig = rig_with_limits();
  LightModel model;
  model.point_lux_per_level = Eigen::MatrixXd::Zero(3, 2);
  ShowController show(rig, model);
  show.apply(at(0), std::vector<double>{0.5, 0.5});
  const auto aimed = show.aim(at(1), 0, {0.2, 0.3, 0}, 1, from_seconds(5));
  ASSERT_FALSE(aimed);
  EXPECT_NE(aimed.error().detail.find("limits"), std::string::npos) << aimed.error().detail;
}

TEST(AnyAim, IsMoreThanWhatAHeadGivesInARoomWhereverItLooks) {
  Random random(3);
  for (const double reflectance : {0.0, 0.5, 0.8}) {
    const Scene scene = make_cube(4, reflectance);
    const RayScene rays(scene);
    Rig rig = rig_with_limits();
    rig.points.resize(1);
    // The middle of the floor, and a place in a corner.
    rig.points.push_back(rig.points[0]);
    rig.points[1].position_world_m = Vec3(1.95, 1.95, -1.99);
    rig.points[0].position_world_m.z() = -1.99;
    const Eigen::MatrixXd most = any_aim_lux_per_level(rig, scene);
    std::vector<Receiver> receivers;
    for (const Point& point : rig.points) receivers.push_back({point.position_world_m, point.normal_world});
    std::vector<Emitter> emitters;
    for (int k = 0; k < 60; ++k) {
      Pose hangs = rig.fixtures[0].world_from_mount;
      const Vec3 off = Vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)).normalized();
      hangs.translation_m += kHangsOff_m * off;
      const auto at_place =
          pan_tilt_towards(hangs, receivers[k % 2].position_world_m - hangs.translation_m, rig.fixtures[0].range, {});
      const Joints aim = k % 3 == 0 && at_place ? *at_place : Joints{random.between(-3, 3), random.between(-2, 2), 0};
      emitters.push_back({rig.luminaires[0].intensity, world_from_lamp(hangs, aim, 0)});
    }
    EvaluateOptions options;
    options.wanted_relative_error = 1e-4;
    options.max_rays = 300'000;
    const auto light = make_path_evaluator(rays)->evaluate(receivers, emitters, options);
    ASSERT_TRUE(light);
    for (Eigen::Index p = 0; p < 2; ++p) {
      EXPECT_GT(most(p, 0), light->lux_per_level.row(p).maxCoeff()) << reflectance << ", place " << p;
      EXPECT_LT(most(p, 0), 12 * light->lux_per_level.row(p).maxCoeff()) << reflectance << ", place " << p;
      EXPECT_EQ(most(p, 1), 0) << "it does not turn";
    }
  }
}

}  // namespace
}  // namespace luxrig
