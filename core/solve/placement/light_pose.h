#pragma once
/// Position and aim of a light.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry.h"

namespace luxrig {

struct LightPose {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 aim_world =
      -Vec3::UnitZ();  ///< unit: direction of its luminaire's -Z; lights without an aim leave it unchanged

  friend bool operator==(const LightPose& a, const LightPose& b) {
    return a.position_world_m == b.position_world_m && a.aim_world == b.aim_world;
  }
};

/// Two unit vectors that make a right-handed basis with `unit`: its columns are first, second, unit. Discontinuous in
/// one direction only (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
[[nodiscard]] inline Mat3 basis_about(const Vec3& unit) {
  const double sign = std::copysign(1.0, unit.z());
  const double a = -1 / (sign + unit.z()), b = unit.x() * unit.y() * a;
  Mat3 basis;
  basis.col(0) = Vec3(1 + sign * unit.x() * unit.x() * a, sign * b, -sign * unit.x());
  basis.col(1) = Vec3(b, sign + unit.y() * unit.y() * a, -unit.y());
  basis.col(2) = unit;
  return basis;
}

/// `hung` turned by the shortest rotation that points its -Z along `aim`.
[[nodiscard]] inline Mat3 aimed_rotation(const Mat3& hung, const Vec3& aim) {
  return shortest_rotation(-hung.col(2), aim) * hung;
}

/// The pose moved by step: metres along x, y and z; with five numbers, also radians by which the aim turns towards the
/// first and second vector of basis_about().
[[nodiscard]] inline LightPose moved(const LightPose& pose, const Eigen::VectorXd& step) {
  LightPose to = pose;
  to.position_world_m += step.head<3>();
  if (step.size() == 5) {
    const double angle_rad = step.tail<2>().norm();
    if (angle_rad > 0) {
      const Vec3 towards = basis_about(pose.aim_world).leftCols<2>() * step.tail<2>() / angle_rad;
      to.aim_world = (std::cos(angle_rad) * pose.aim_world + std::sin(angle_rad) * towards).normalized();
    }
  }
  return to;
}

}  // namespace luxrig
