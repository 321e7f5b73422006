#pragma once
/// Meshes from files (OBJ, STL, glTF/GLB through assimp; PLY).

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
/// world +Y), node transforms applied, names and colours kept of the materials that a triangle uses, cleaned with a
/// count. The Scene has one object, named after the file, and origin zero. Refuses a file that cannot be read, that
/// holds no usable triangle, or more than 50 million.
[[nodiscard]] Checked<Scene> load_mesh(const MeshFile& file);

}  // namespace luxrig
