#pragma once
/// Reads meshes from files (OBJ, PLY, STL, glTF/GLB, 3DS).

#include <filesystem>

#include "core/result.h"
#include "core/scene/scene.h"

namespace luxrig {

enum class UpAxis { x, y, z };

struct MeshFile {
  std::filesystem::path path;
  double metres_per_unit = 1.0;
  UpAxis up_axis = UpAxis::y;
};

/// Reads a mesh as a Scene with one object, named after the file:
/// - units applied, +Z up (a +Y-up file is turned by +90° about X, so that its -Z becomes world +Y), node transforms
///   applied
/// - cleaned, with counts
/// - only materials in use, split into shades of one name if a picture or vertex colours vary
/// - origin zero, or the middle of a mesh that extends beyond 1 km
/// Refuses a file that cannot be read, has no usable triangle, or has more than 50 million.
[[nodiscard]] Checked<Scene> load_mesh(const MeshFile& file);

}  // namespace luxrig
