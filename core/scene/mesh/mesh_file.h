#pragma once
/// Meshes from files (OBJ, PLY, STL, glTF/GLB, 3DS).

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

/// Reads a mesh: units applied, +Z up (a +Y-up file is turned by +90° about X, so that its -Z becomes
/// world +Y), node transforms applied, cleaned with a count; materials that a triangle uses, in shades of one name
/// where a picture or vertex colours vary. The Scene has one object, named after the file; its origin is zero, or the
/// middle of what reaches over 1 km out. Refuses what cannot be read, has no usable triangle, or more than 50 million.
[[nodiscard]] Checked<Scene> load_mesh(const MeshFile& file);

}  // namespace luxrig
