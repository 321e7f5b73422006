#include "core/calibration/camera_offset.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/picture/rig_camera.h"

namespace luxrig {
namespace {

/// Without roll: to the right, up, ahead.
Mat3 level_axes(const Vec3& ahead) {
  Mat3 axes;
  axes.col(0) = ahead.cross(std::abs(ahead.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ()).normalized();
  axes.col(1) = axes.col(0).cross(ahead);
  axes.col(2) = ahead;
  return axes;
}

/// Of its picture, as picture.h has it: positive roll lowers the right side.
Mat3 axes_of(const Camera& camera) {
  const Mat3 level = level_axes((camera.target_world_m - camera.eye_world_m).normalized());
  Mat3 axes = level;
  axes.col(0) = std::cos(camera.roll_rad) * level.col(0) - std::sin(camera.roll_rad) * level.col(1);
  axes.col(1) = axes.col(0).cross(level.col(2));
  return axes;
}

}  // namespace

CameraOffset offset_between(const Camera& from, const Camera& to) {
  const Eigen::AngleAxisd turn(Mat3(axes_of(to) * axes_of(from).transpose()));
  CameraOffset offset;
  offset << to.eye_world_m - from.eye_world_m, turn.angle() * turn.axis(),
      std::log(to.vertical_fov_rad / from.vertical_fov_rad), to.distortion - from.distortion;
  return offset;
}

Camera offset_by(const Camera& from, const CameraOffset& offset) {
  const Vec3 turn_rad = offset.segment<3>(3);
  const double angle_rad = turn_rad.norm();
  Mat3 turn = Mat3::Identity();
  if (angle_rad > 0) turn = Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad).toRotationMatrix();
  const Mat3 axes = turn * axes_of(from);
  Camera to = from;
  to.eye_world_m += offset.head<3>();
  to.target_world_m = to.eye_world_m + (from.target_world_m - from.eye_world_m).norm() * axes.col(2);
  const Mat3 level = level_axes((to.target_world_m - to.eye_world_m).normalized());
  to.roll_rad = std::atan2(-axes.col(0).dot(level.col(1)), axes.col(0).dot(level.col(0)));
  to.vertical_fov_rad *= std::exp(offset[6]);
  to.distortion += offset[7];
  return to;
}

void put_view(const Camera& stated, const Camera& found, const CameraCovariance& covariance, CalibratedCamera& into) {
  const CameraOffset off = offset_between(stated, found);
  const CameraOffset error = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  into.offset_m = off.head<3>();
  into.offset_error_m = error.head<3>();
  into.turn_deg = off.segment<3>(3) * (180 / kPi);
  into.turn_error_deg = error.segment<3>(3) * (180 / kPi);
  const double fov_deg = deg_from_rad(found.vertical_fov_rad);
  into.fov_deg = {fov_deg, fov_deg * error[6]};
  into.distortion = {found.distortion, error[7]};
}

Camera view_of(const PictureCamera& stated, const CalibratedCamera& found) {
  Camera camera = view_of(stated);
  CameraOffset offset;
  offset << found.offset_m, found.turn_deg * (kPi / 180),
      std::log(rad_from_deg(found.fov_deg.value) / camera.vertical_fov_rad), found.distortion.value - camera.distortion;
  return offset_by(camera, offset);
}

}  // namespace luxrig
