#pragma once
#include "core/geometry.h"

namespace luxrig {

/// A lamp at one point whose beam (-Z) goes through another.
inline Pose lamp_at(const Vec3& position_m, const Vec3& aim_m) {
  const Vec3 z = (position_m - aim_m).normalized();
  const Vec3 x = z.cross(std::abs(z.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  Pose pose;
  pose.rotation << x, z.cross(x), z;
  pose.translation_m = position_m;
  return pose;
}

}  // namespace luxrig
