#pragma once
/// Places to try: the centres of cubes that fill a box.

#include <Eigen/Geometry>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// x fastest, then y, then z. spacing_m > 0.
[[nodiscard]] inline std::vector<Vec3> lattice_in(const Eigen::AlignedBox3d& box_m, double spacing_m) {
  std::vector<Vec3> places_m;
  const Vec3 first_m = box_m.min() + Vec3::Constant(spacing_m / 2);
  for (double z = first_m.z(); z < box_m.max().z(); z += spacing_m)
    for (double y = first_m.y(); y < box_m.max().y(); y += spacing_m)
      for (double x = first_m.x(); x < box_m.max().x(); x += spacing_m) places_m.emplace_back(x, y, z);
  return places_m;
}

}  // namespace luxrig
