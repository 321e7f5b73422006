#pragma once
/// STL, ascii and binary, read here. Internal to core/scene.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Triangles; normals and colours are left out. Refuses a binary file that is shorter than it promises, and, with line
/// and column, an ascii one with words that are no numbers. `file` is for the messages.
[[nodiscard]] Checked<PolygonMesh> read_stl(std::string bytes, const std::string& file);

}  // namespace luxrig
