#include "sim/world/deviations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rig/frames.h"
#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

/// Between a point and a corner of the object that it lies on.
constexpr double kOnAnObject_m = 0.3;
constexpr int kHalvings = 6;  // of an offset that leads through a surface; then there is none

/// Emitters of one housing hang together.
std::size_t mount_of(const Rig& rig, std::size_t f) { return rig.fixtures[f].housing.value_or(f); }

Mat3 turn(const Vec3& rad) {
  const double angle_rad = rad.norm();
  return angle_rad > 0 ? Eigen::AngleAxisd(angle_rad, rad / angle_rad).toRotationMatrix() : Mat3::Identity();
}

void hang_wrongly(const Deviations& deviations, std::size_t mount, FixtureTruth& truth) {
  if (!(random_unit(deviations.seed, Draw::wrong_head, mount, 0) < deviations.wrong_heads)) return;
  switch (random_bits(deviations.seed, Draw::wrong_head, mount, 1) % 3) {
    case 0:  // upside down, as on a floor
      truth.world_from_mount.rotation =
          truth.world_from_mount.rotation * Eigen::AngleAxisd(kPi, Vec3::UnitX()).toRotationMatrix();
      return;
    case 1:
      truth.head.pan_scale = -1;
      return;
    default:  // set to 540° on the head, to 630° in the file
      truth.head.pan_scale = 540.0 / 630.0;
      return;
  }
}

}  // namespace

Deviations Deviations::none() {
  Deviations none;
  none.output_min = none.output_max = 1;
  none.curve_exponent_spread = none.position_error_m = none.angle_error_rad = 0;
  none.meter_gain_share = none.meter_noise = none.meter_lag_s = none.lamp_lag_s = 0;
  return none;
}

Deviations Deviations::real() {
  Deviations real;
  real.output_max = 1.2;
  real.drive_exponent_min = 0.8;
  real.drive_exponent_max = 2.4;
  real.dead_band = 0.04;
  real.tail = 0.01;
  real.warm_up_share = 0.05;
  real.ageing_per_hour = 1e-5;  // 10 % in ten thousand hours
  real.photometry_angle_rad = rad_from_deg(3);
  real.position_error_m = 0.05;                // up to 15 cm
  real.angle_error_rad = rad_from_deg(5) / 3;  // up to 5°
  real.backlash_rad = rad_from_deg(2);
  real.head_speed_share = 0.15;
  real.head_lag_s = 0.06;
  real.reflectance_spread = 0.15;
  real.object_error_m = 0.05;
  real.cloud_share = 0.3;
  real.visits_per_hour = 4;
  real.meter_gain_share = 1;
  real.meter_noise = 0.02;
  real.meter_latency_min_s = 0.1;
  real.meter_latency_max_s = 2;
  real.meter_cosine_exponent = 0.1;
  real.meter_drift_per_hour = 0.001;
  real.camera_angle_rad = rad_from_deg(1);
  real.camera_position_m = 0.03;
  real.camera_field_share = 0.02;
  real.camera_distortion = 0.02;  // a twentieth or less in the corner of a wide picture
  real.camera_vignetting = 0.5;
  real.camera_flare = 0.03;
  real.camera_halo = 0.03;
  real.camera_log_response = 0.576;  // half of ln(0.136 / 0.043): factors published for fluorescent and halogen lamps
  return real;
}

Deviations Deviations::bad() {
  Deviations bad = real();
  bad.output_min = 0.6;
  bad.wrong_heads = 0.25;
  bad.wrong_lines = 0.1;
  return bad;
}

std::vector<FixtureTruth> draw_fixtures(const Rig& rig, const Deviations& deviations, const RayScene* room) {
  const std::uint64_t seed = deviations.seed;
  std::vector<FixtureTruth> truths;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const std::size_t mount = mount_of(rig, f);
    FixtureTruth truth;
    truth.line = f;
    truth.output = deviations.output_min +
                   (deviations.output_max - deviations.output_min) * random_unit(seed, Draw::lamp_output, f, 0);
    truth.curve_exponent = 1 + deviations.curve_exponent_spread * random_signed(seed, Draw::curve_exponent, f, 0);
    if (deviations.drive_exponent_min > 0) {
      truth.of_drive = true;
      truth.curve_exponent =
          deviations.drive_exponent_min + (deviations.drive_exponent_max - deviations.drive_exponent_min) *
                                              random_unit(seed, Draw::drive_exponent, f, 0);
    }
    truth.dead_band = deviations.dead_band * random_unit(seed, Draw::dead_band, f, 0);
    truth.tail = deviations.tail * random_unit(seed, Draw::tail, f, 0);
    truth.warm_up_share = deviations.warm_up_share * random_unit(seed, Draw::warm_up, f, 0);
    truth.ageing_per_hour = deviations.ageing_per_hour * random_unit(seed, Draw::ageing, f, 0);
    truth.head.backlash_rad = deviations.backlash_rad * random_unit(seed, Draw::backlash, mount, 0);
    truth.head.speed_share =
        1 + deviations.head_speed_share * (0.5 - 1.5 * random_unit(seed, Draw::head_speed, mount, 0));
    truth.head.lag_s = deviations.head_lag_s * random_unit(seed, Draw::head_lag, mount, 0);
    Vec3 offset_m, turn_rad;
    for (int axis = 0; axis < 3; ++axis) {
      const auto counter = static_cast<std::uint64_t>(axis);
      offset_m[axis] = deviations.position_error_m * random_normal(seed, Draw::mount_position, mount, counter);
      turn_rad[axis] = deviations.angle_error_rad * random_normal(seed, Draw::mount_angle, mount, counter);
    }
    truth.world_from_mount = rig.fixtures[f].world_from_mount;
    const Vec3 stated_m = truth.world_from_mount.translation_m;
    // A lamp under a ceiling is not 10 cm above it.
    for (int k = 0; room && k < kHalvings && room->occluded(stated_m, Vec3::Zero(), stated_m + offset_m); ++k)
      offset_m *= k + 1 < kHalvings ? 0.5 : 0.0;
    truth.world_from_mount.translation_m += offset_m;
    truth.world_from_mount.rotation = turn(turn_rad) * truth.world_from_mount.rotation;
    if (deviations.photometry_angle_rad > 0) {
      const double about_rad = kPi * random_signed(seed, Draw::photometry_angle, f, 0);
      truth.photometry_from_lamp =
          turn(deviations.photometry_angle_rad * random_unit(seed, Draw::photometry_angle, f, 1) *
               Vec3(std::cos(about_rad), std::sin(about_rad), 0));
    }
    if (rig.fixtures[f].moves) hang_wrongly(deviations, mount, truth);
    truths.push_back(truth);
  }
  for (std::size_t f = 0; f + 1 < truths.size(); ++f) {
    if (!(random_unit(seed, Draw::wrong_line, f, 0) < deviations.wrong_lines)) continue;
    // Two of a kind, each alone in its housing.
    if (truths[f].line != f || rig.fixtures[f].moves != rig.fixtures[f + 1].moves || rig.fixtures[f].housing ||
        rig.fixtures[f + 1].housing)
      continue;
    std::swap(truths[f].line, truths[f + 1].line);
  }
  return truths;
}

Pose true_lamp(const FixtureTruth& truth, const Joints& joints, double roll_rad) {
  Pose pose = world_from_lamp(truth.world_from_mount, joints, roll_rad);
  pose.rotation = pose.rotation * truth.photometry_from_lamp;
  return pose;
}

Joints true_joints(const FixtureTruth& truth, const Joints& commanded) {
  Joints joints = commanded;
  joints.pan_rad *= truth.head.pan_scale;
  return joints;
}

Scene true_scene(Scene scene, const Rig& rig, const Deviations& deviations) {
  for (std::size_t m = 0; m < scene.materials.size() && deviations.reflectance_spread > 0; ++m) {
    const double factor = 1 + deviations.reflectance_spread * random_signed(deviations.seed, Draw::reflectance, m, 0);
    scene.materials[m].reflectance_rgb = (factor * scene.materials[m].reflectance_rgb).cwiseMin(kMaxReflectance);
  }
  if (!(deviations.object_error_m > 0)) return scene;
  const std::size_t objects = scene.object_names.size();
  std::vector<std::uint32_t> object_of_vertex(scene.vertices_m.size(), 0);
  std::vector<Eigen::AlignedBox3d> box(objects);
  for (std::size_t t = 0; t < scene.triangles.size(); ++t)
    for (const std::uint32_t v : scene.triangles[t]) {
      object_of_vertex[v] = scene.object_of_triangle[t];
      box[object_of_vertex[v]].extend(scene.vertex_world_m(v));
    }
  // A point on an object is where the object is: such objects stay. By its box, as a picture has points far from corners.
  std::vector<bool> stays(objects, false);
  const auto keep = [&](const Vec3& point_m) {
    for (std::size_t o = 1; o < objects; ++o)
      if (!box[o].isEmpty() && box[o].exteriorDistance(point_m) < kOnAnObject_m) stays[o] = true;
  };
  for (const Point& point : rig.points) keep(point.position_world_m);
  for (const Luxmeter& meter : rig.luxmeters) keep(meter.position_world_m);
  for (std::size_t v = 0; v < scene.vertices_m.size(); ++v) {
    const std::uint32_t object = object_of_vertex[v];
    if (object == 0 || stays[object]) continue;  // 0: the room itself
    const double about_rad = kPi * random_signed(deviations.seed, Draw::object_place, object, 0);
    const double far_m = deviations.object_error_m * random_unit(deviations.seed, Draw::object_place, object, 1);
    scene.vertices_m[v] +=
        Vec3f(static_cast<float>(far_m * std::cos(about_rad)), static_cast<float>(far_m * std::sin(about_rad)), 0);
  }
  return scene;
}

}  // namespace luxrig::sim
