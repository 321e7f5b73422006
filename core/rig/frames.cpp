#include "core/rig/frames.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

// Rounding error of an angle; a joint this far past its stop counts as on it.
constexpr double kSlack_rad = 1e-9;
// Below this sine of the tilt, turning the pan moves the beam by less than 1 nm per metre.
constexpr double kVertical = 1e-9;

/// The image angle + 2πk nearest to `from` within [min, max]; nullopt if there is none.
std::optional<double> nearest_image(double angle_rad, double from_rad, double min_rad, double max_rad) {
  constexpr double kTurn = 2 * kPi;
  const double first = std::ceil((min_rad - kSlack_rad - angle_rad) / kTurn);
  const double last = std::floor((max_rad + kSlack_rad - angle_rad) / kTurn);
  if (!(first <= last)) return std::nullopt;
  const double turns = std::clamp(std::round((from_rad - angle_rad) / kTurn), first, last);
  return std::clamp(angle_rad + turns * kTurn, min_rad, max_rad);
}

}  // namespace

Pose displaced(const Pose& world_from_mount, const Vec3& offset_world_m, const Vec3& turn_world_rad) {
  Pose pose = world_from_mount;
  pose.translation_m += offset_world_m;
  const double angle_rad = turn_world_rad.norm();
  if (angle_rad > 0) pose.rotation = Eigen::AngleAxisd(angle_rad, turn_world_rad / angle_rad) * pose.rotation;
  return pose;
}

Pose world_from_lamp(const Pose& world_from_mount, const Joints& joints, double roll_rad) {
  const Mat3 mount_from_lamp =
      (Eigen::AngleAxisd(joints.pan_rad, Vec3::UnitZ()) * Eigen::AngleAxisd(joints.tilt_rad, Vec3::UnitX()) *
       Eigen::AngleAxisd(roll_rad, Vec3::UnitZ()))
          .toRotationMatrix();
  return {world_from_mount.rotation * mount_from_lamp, world_from_mount.translation_m};
}

std::optional<Joints> pan_tilt_towards(const Pose& world_from_mount, const Vec3& direction_world,
                                       const JointRange& range, const Joints& from) {
  const double length = direction_world.stableNorm();
  LUXRIG_CHECK(length > 0 && std::isfinite(length), "no direction: ({}, {}, {})", direction_world.x(),
               direction_world.y(), direction_world.z());
  if (range.pan_min_rad > range.pan_max_rad) return std::nullopt;

  const Vec3 d = world_from_mount.inverse_direction(direction_world / length);
  const double across = std::hypot(d.x(), d.y());
  const double tilt_rad = std::atan2(across, -d.z());
  const bool pan_is_free = across < kVertical;
  const double pan_rad = std::atan2(-d.x(), d.y());

  // The same beam has two postures: (pan, tilt), or flipped (pan + 180°, -tilt).
  std::optional<Joints> best;
  double best_move_rad = 0;
  bool best_flips = false;
  for (const double flip : {0.0, 1.0}) {
    const auto pan = pan_is_free
                         ? std::optional(std::clamp(from.pan_rad, range.pan_min_rad, range.pan_max_rad))
                         : nearest_image(pan_rad + flip * kPi, from.pan_rad, range.pan_min_rad, range.pan_max_rad);
    const auto tilt =
        nearest_image(flip == 0 ? tilt_rad : -tilt_rad, from.tilt_rad, range.tilt_min_rad, range.tilt_max_rad);
    if (!pan || !tilt) continue;
    const double move_rad = std::max(std::abs(*pan - from.pan_rad), std::abs(*tilt - from.tilt_rad));
    const bool flips = (*tilt < 0) != (from.tilt_rad < 0);  // on a tie, the beam does not swing through straight down
    const bool tie = best && std::abs(move_rad - best_move_rad) <= kSlack_rad;
    if (!best || (tie ? best_flips && !flips : move_rad < best_move_rad)) {
      best = Joints{*pan, *tilt, from.beam_rad};
      best_move_rad = move_rad;
      best_flips = flips;
    }
  }
  return best;
}

}  // namespace luxrig
