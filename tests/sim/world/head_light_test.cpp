#include "sim/world/head_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/tasks/rig_transport.h"
#include "core/transport/evaluator.h"
#include "tests/sim/world/head_light_fixture.h"

namespace luxrig::sim {
namespace {

using namespace head_light_fixture;

TEST(HeadLight, DirectPartMatchesTheDirectEvaluatorAtAnyAim) {
  const Room room(0.5);
  const std::vector<Joints> aims = random_aims(500, 3);
  std::vector<Emitter> emitters;
  for (const Joints& joints : aims) emitters.push_back({room.spot, world_from_lamp(room.pose, joints, kRoll_rad)});
  const auto direct = make_direct_evaluator(room.rays)->evaluate(room.receivers, emitters, {});
  ASSERT_TRUE(direct);
  const auto light = room.head_light({{}}, room.zeros());  // no indirect light at all
  const double brightest_lx = direct->lux_per_level.maxCoeff();
  ASSERT_GT(brightest_lx, 100);
  for (std::size_t a = 0; a < aims.size(); ++a) {
    Eigen::VectorXd lux = Eigen::VectorXd::Constant(room.zeros().size(), 77);  // previous contents are overwritten
    light->column(kFixture, aims[a], lux);
    for (Eigen::Index r = 0; r < lux.size(); ++r) {
      const double exact_lx = direct->lux_per_level(r, static_cast<Eigen::Index>(a));
      EXPECT_NEAR(lux[r], exact_lx, 1e-6 * std::max(exact_lx, 1e-3 * brightest_lx)) << "aim " << a << ", row " << r;
    }
  }
}

TEST(HeadLight, DirectPartOfALampWithSizeAndTiltMatchesThePlanner) {
  const Room room(0.5);
  HeadSamples head;
  head.fixture = kFixture;
  head.world_from_mount = room.pose;
  head.roll_rad = kRoll_rad;
  head.luminaire.intensity = make_lambertian(900);
  head.luminaire.shape = {LuminousShape::Kind::rectangle, Vec3(1.2, 0.4, 0)};
  head.luminaire.colour_rgb = Vec3(1.3, 0.95, 0.6);
  head.luminaire.tilt = LampTilt{3, {0, 90, 180}, {1.0, 0.7, 0.5}};
  head.aims_mount = {beam_mount({})};
  head.indirect_lux_per_level = room.zeros();
  std::vector<Joints> aims = random_aims(30, 5);
  std::vector<Emitter> emitters;
  for (const Joints& joints : aims)
    emitters.push_back(emitter_of(head.luminaire, world_from_lamp(room.pose, joints, kRoll_rad)));
  EXPECT_NE(emitters[0].intensity->flux_lm(), 900) << "the factor counts";
  EvaluateOptions options;
  options.wanted_relative_error = 1e-3;
  // Without the room: a panel of this size would cut into its ceiling when it turns.
  const Scene nothing;
  const RayScene empty(nothing);
  head.sees = seen_shares(empty, room.receivers, emitters[0]);
  EXPECT_EQ(head.sees, std::vector<double>(room.receivers.size(), 1.0));
  const auto direct = make_direct_evaluator(empty)->evaluate(room.receivers, emitters, options);
  ASSERT_TRUE(direct);
  const auto light = make_head_light(room.receivers, {head});
  const double brightest_lx = direct->lux_per_level.maxCoeff();
  ASSERT_GT(brightest_lx, 20);
  Eigen::VectorXd lux = room.zeros();
  for (std::size_t a = 0; a < aims.size(); ++a) {
    light->column(kFixture, aims[a], lux);
    EXPECT_LT((lux - direct->lux_per_level.col(static_cast<Eigen::Index>(a))).cwiseAbs().maxCoeff(),
              3e-3 * brightest_lx)
        << "aim " << a;
  }
}

TEST(HeadLight, DirectPartFollowsTheZoom) {
  const Room room(0.5);
  HeadSamples head;
  head.fixture = kFixture;
  head.world_from_mount = room.pose;
  head.luminaire.model = LuminaireModel::spot;
  head.luminaire.beam_angle_rad = rad_from_deg(20);
  head.luminaire.field_angle_rad = rad_from_deg(36);
  head.luminaire.zoom_beam_rad = {rad_from_deg(6), rad_from_deg(60)};
  head.luminaire.intensity = make_spot(1000, rad_from_deg(20), rad_from_deg(36));
  head.sees.assign(room.receivers.size(), 1.0);
  head.aims_mount = {beam_mount({})};
  head.indirect_lux_per_level = room.zeros();
  const auto light = make_head_light(room.receivers, {head});
  Eigen::VectorXd lux = room.zeros();
  for (const double beam_deg : {6.0, 20.0, 45.0}) {
    light->column(kFixture, {0.1, 0.2, rad_from_deg(beam_deg)}, lux);
    const Intensity spot = make_spot(1000, rad_from_deg(beam_deg), rad_from_deg(1.8 * beam_deg));
    const Pose lamp = world_from_lamp(room.pose, {0.1, 0.2}, 0);
    for (std::size_t r = 0; r < room.receivers.size(); ++r) {
      const Vec3 from_m = room.receivers[r].position_world_m - lamp.translation_m;
      const double cosine = std::max(0.0, -room.receivers[r].normal_world.dot(from_m.normalized()));
      const double exact_lx =
          spot->intensity_cd(lamp.inverse_direction(from_m.normalized())) * cosine / from_m.squaredNorm();
      EXPECT_NEAR(lux[static_cast<Eigen::Index>(r)], exact_lx, 1e-6 * std::max(exact_lx, 1.0)) << beam_deg << ", " << r;
    }
  }
}

TEST(HeadLight, AScreenHidesItsShareOfALampWithSize) {
  // A disk of 1 m; a screen half way to the receiver below its middle covers x < 0.
  const Emitter lamp{
      make_lambertian(1000), {Mat3::Identity(), Vec3::Zero()}, {LuminousShape::Kind::disk, Vec3(1, 0, 0)}};
  const std::vector<Receiver> below = {{{0, 0, -1.9}, Vec3::UnitZ()}};
  Scene scene;
  scene.vertices_m = {{-5, -5, -0.95f}, {0, -5, -0.95f}, {0, 5, -0.95f}, {-5, 5, -0.95f}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.material_of_triangle = scene.object_of_triangle = {0, 0};
  scene.materials.resize(1);
  scene.object_names = {"scene"};
  const auto share = [&](const Scene& in) { return seen_shares(RayScene(in), below, lamp)[0]; };
  EXPECT_EQ(share(Scene{}), 1);
  EXPECT_NEAR(share(scene), 0.5, 0.05);
  for (Vec3f& vertex : scene.vertices_m) vertex.x() += 2;  // now x < 2: all of it
  EXPECT_EQ(share(scene), 0);
}

TEST(HeadLight, AReceiverThatTheHeadCannotSeeHasNoDirectLight) {
  const Room room(0.5);
  HeadSamples head;
  head.world_from_mount = room.pose;
  head.luminaire.intensity = make_isotropic(1000);
  head.sees.assign(room.receivers.size(), 1.0);
  head.sees[2] = 0;
  head.aims_mount = {beam_mount({})};
  head.indirect_lux_per_level = room.zeros();
  Eigen::VectorXd lux = room.zeros();
  make_head_light(room.receivers, {head})->column(0, {}, lux);
  EXPECT_EQ(lux[2], 0);
  EXPECT_GT(lux[1], 0);
}

TEST(HeadLight, IndirectPartIsExactAtItsSampledAims) {
  const Room room(0.5);
  const std::vector<Joints> set = spread_aims(kRange, 32);
  const auto count = static_cast<Eigen::Index>(set.size());
  Eigen::MatrixXd indirect(room.zeros().size(), count);
  for (Eigen::Index a = 0; a < count; ++a) indirect.col(a).setConstant(10.0 + static_cast<double>(a));
  const auto light = room.head_light(set, indirect), dark = room.head_light(set, 0 * indirect);
  Eigen::VectorXd lux = room.zeros(), direct = room.zeros();
  for (Eigen::Index a = 0; a < count; ++a) {
    light->column(kFixture, set[static_cast<std::size_t>(a)], lux);
    dark->column(kFixture, set[static_cast<std::size_t>(a)], direct);
    EXPECT_LT((lux - direct - indirect.col(a)).cwiseAbs().maxCoeff(), 1e-9) << a;
  }
  for (const Joints& joints : random_aims(200, 4)) {  // in between: an average, never outside the known values
    light->column(kFixture, joints, lux);
    dark->column(kFixture, joints, direct);
    EXPECT_GE((lux - direct).minCoeff(), 10 - 1e-9);
    EXPECT_LE((lux - direct).maxCoeff(), 10 + static_cast<double>(count - 1) + 1e-9);
  }
}

TEST(SpreadAims, StayInRangeAndReachAllOfIt) {
  const JointRange ranges[] = {
      kRange,       {-kPi, kPi, -kPi / 2, kPi / 2}, {-kPi, kPi, 0, kPi}, {-kPi, kPi, -0.1, 0.1}, {-0.5, 0.8, -0.2, 1.5},
      {0, 0, 0, 0},
  };
  for (const JointRange& range : ranges) {
    for (const int count : {0, 1, 8, 32, 500}) {
      const std::vector<Joints> aims = spread_aims(range, count);
      EXPECT_LE(aims.size(), static_cast<std::size_t>(count));
      for (const Joints& joints : aims) {
        EXPECT_GE(joints.pan_rad, range.pan_min_rad);
        EXPECT_LE(joints.pan_rad, range.pan_max_rad);
        EXPECT_GE(joints.tilt_rad, range.tilt_min_rad);
        EXPECT_LE(joints.tilt_rad, range.tilt_max_rad);
      }
    }
  }
}

TEST(SpreadAims, LeaveNoGapLargerThanTheirNumberImplies) {
  const std::vector<Joints> aims = spread_aims(kRange, 32);
  ASSERT_EQ(aims.size(), 32u);
  double widest_rad = 0;
  for (const Joints& joints : random_aims(2000, 5)) {
    double nearest_rad = kPi;
    for (const Joints& aim : aims) {
      const double cosine = beam_mount(joints).dot(beam_mount(aim));
      nearest_rad = std::min(nearest_rad, std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
    widest_rad = std::max(widest_rad, nearest_rad);
  }
  // 32 equal caps over the same area, 2π(1 - cos 135°), have a radius of 0.47 rad; a lattice leaves corners.
  EXPECT_LT(widest_rad, 1.6 * std::acos(1 - (1 - std::cos(0.75 * kPi)) / 32));
}

TEST(BeamMount, IsMinusZOfTheLampInTheMountFrame) {
  for (const Joints& joints : random_aims(100, 6)) {
    const Vec3 beam = -world_from_lamp(Pose{}, joints, kRoll_rad).rotation.col(2);
    EXPECT_LT((beam - beam_mount(joints)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace luxrig::sim
