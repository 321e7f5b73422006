#pragma once
/// Reader of 3D Studio's .3ds, as used in MVR and GDTF files. Internal to core/scene, and to the import of MVR scenery.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Reads the triangles of all meshes with their materials' diffuse colours (as sRGB) and pictures, in the file's unit
/// and axes (+Z up by custom). Skips animation, lights and cameras. `file` is for messages.
[[nodiscard]] Checked<PolygonMesh> read_3ds(std::string_view bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
