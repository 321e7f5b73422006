#pragma once
/// 3D Studio's .3ds, as MVR and GDTF files hold it. Internal to core/scene, and to the import of MVR scenery.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// The triangles of all meshes with their materials' diffuse colours (as sRGB) and pictures, in the file's unit and
/// axes (+Z up by custom). Animation, lights and cameras are left out. `file` is for the messages.
[[nodiscard]] Checked<PolygonMesh> read_3ds(std::string_view bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
