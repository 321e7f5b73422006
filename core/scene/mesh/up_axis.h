#pragma once
/// From the axes of a mesh file to the world's.

#include "core/geometry.h"
#include "core/scene/mesh/mesh_file.h"

namespace luxrig {

/// world_from_mesh for the up axis: a proper rotation that turns it to +Z.
[[nodiscard]] inline Mat3 rotation_to_z_up(UpAxis up) {
  Mat3 rotation = Mat3::Identity();
  switch (up) {
    case UpAxis::x:  // about -Y: x -> z, z -> -x
      rotation << 0, 0, -1, 0, 1, 0, 1, 0, 0;
      break;
    case UpAxis::y:  // about +X: y -> z, z -> -y
      rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
      break;
    case UpAxis::z:
      break;
  }
  return rotation;
}

}  // namespace luxrig
