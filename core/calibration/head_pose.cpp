#include "core/calibration/head_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

/// The beam is put on its place by its own error, of which a step leaves little unless it is near the pan's axis.
constexpr int kSteps = 12;
constexpr double kThere_rad = 1e-9;

Mat3 half_turned(const Mat3& mount, bool upside_down) {
  return upside_down ? Mat3(mount * Vec3(1, -1, -1).asDiagonal()) : mount;
}

/// What a joint reaches whose commands have this range.
std::pair<double, double> reached(double min_rad, double max_rad, double scale) {
  return std::minmax(scale * min_rad, scale * max_rad);
}

}  // namespace

Pose HeadPose::world_from_mount() const {
  return displaced({half_turned(stated.rotation, upside_down), stated.translation_m},
                   parameters.segment<3>(kHeadOffset), parameters.segment<3>(kHeadTurn));
}

Vec3 HeadPose::beam_world(const Joints& sent, const Approach& from) const {
  return head_beam<double>(half_turned(stated.rotation, upside_down), parameters.data(), sent, from);
}

std::optional<Joints> HeadPose::joints_towards(const Vec3& direction_world, const Approach& from,
                                               const JointRange& range, const Joints& near) const {
  const double length = direction_world.stableNorm();
  LUXRIG_CHECK(length > 0 && std::isfinite(length), "no direction");
  const double pan_scale = parameters[kHeadPanScale], tilt_scale = parameters[kHeadTiltScale];
  if (!(std::abs(pan_scale) > 0 && std::abs(tilt_scale) > 0) || range.pan_min_rad > range.pan_max_rad ||
      range.tilt_min_rad > range.tilt_max_rad)
    return std::nullopt;
  const double pan_lag_rad = std::copysign(0.5, pan_scale) * from.pan * parameters[kHeadPanPlay];
  const double tilt_lag_rad = std::copysign(0.5, tilt_scale) * from.tilt * parameters[kHeadTiltPlay];
  JointRange truly = range;
  std::tie(truly.pan_min_rad, truly.pan_max_rad) = reached(range.pan_min_rad, range.pan_max_rad, pan_scale);
  std::tie(truly.tilt_min_rad, truly.tilt_max_rad) = reached(range.tilt_min_rad, range.tilt_max_rad, tilt_scale);
  const Joints near_truly{near.pan_rad * pan_scale, near.tilt_rad * tilt_scale, near.beam_rad};
  const Pose mount = world_from_mount();
  const Vec3 wanted = direction_world / length;
  Vec3 asked = wanted;
  for (int step = 0; step < kSteps; ++step) {
    const auto turned = pan_tilt_towards(mount, asked, truly, near_truly);
    if (!turned) return std::nullopt;
    Joints sent = *turned;
    sent.pan_rad = std::clamp((turned->pan_rad + pan_lag_rad) / pan_scale, range.pan_min_rad, range.pan_max_rad);
    sent.tilt_rad = std::clamp((turned->tilt_rad + tilt_lag_rad) / tilt_scale, range.tilt_min_rad, range.tilt_max_rad);
    const Vec3 there = beam_world(sent, from);
    if ((there - wanted).norm() < kThere_rad) return sent;
    asked = shortest_rotation(there, wanted) * asked;
  }
  return std::nullopt;
}

}  // namespace luxrig
