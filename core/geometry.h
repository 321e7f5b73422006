#pragma once
/// Vectors and poses. World frame: right-handed, +Z up, metres.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>

namespace luxrig {

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;

/// A rigid transform `to_from_from`: point_to = rotation * point_from + translation_m.
struct Pose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_m = Vec3::Zero();

  [[nodiscard]] Vec3 point(const Vec3& point_from) const { return rotation * point_from + translation_m; }
  [[nodiscard]] Vec3 direction(const Vec3& direction_from) const { return rotation * direction_from; }
  [[nodiscard]] Vec3 inverse_direction(const Vec3& direction_to) const { return rotation.transpose() * direction_to; }
};

/// The shortest rotation that turns `from` to `to`, both unit vectors. For opposite vectors: a half turn about an axis
/// at right angles to both, always the same. Orthonormal and exact to rounding, however near to opposite they are.
[[nodiscard]] Mat3 shortest_rotation(const Vec3& from, const Vec3& to);

inline constexpr double kPi = std::numbers::pi;
[[nodiscard]] constexpr double rad_from_deg(double deg) { return deg * (kPi / 180.0); }
[[nodiscard]] constexpr double deg_from_rad(double rad) { return rad * (180.0 / kPi); }

}  // namespace luxrig
