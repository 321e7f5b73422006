#pragma once
/// Reader of STL, ascii and binary. Internal to core/scene.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Reads triangles; skips normals and colours. Refuses a binary file shorter than it promises, and an ascii one with
/// invalid numbers, with line and column. `file` is for messages.
[[nodiscard]] Checked<PolygonMesh> read_stl(std::string bytes, const std::string& file);

}  // namespace luxrig
