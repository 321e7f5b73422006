#pragma once
/// Strict reader of Wavefront OBJ: in double, with lines and columns. Internal to core/scene.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Reads polygons with their materials, textures and vertex colours (as sRGB). Skips points, lines, curves and normals.
/// UTF-8 or UTF-16. Refuses invalid numbers (decimal commas), with line and column, and files beyond kMaxTriangles and
/// kMaxCorners. `file` is for messages.
[[nodiscard]] Checked<PolygonMesh> read_obj(std::string bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
