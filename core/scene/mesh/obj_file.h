#pragma once
/// Wavefront OBJ, read here: in double, strictly, with lines and columns. Internal to core/scene.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Polygons with their materials, textures and vertex colours (as sRGB); points, lines, curves and normals are left
/// out. UTF-8 or UTF-16. Refuses numbers that are none (decimal commas), with line and column, and what is larger than
/// kMaxTriangles and kMaxCorners allow. `file` is for the messages.
[[nodiscard]] Checked<PolygonMesh> read_obj(std::string bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
