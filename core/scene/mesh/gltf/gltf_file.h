#pragma once
/// Reader of glTF 2.0, .gltf and .glb. Files are untrusted, so every bound is checked. Source: Khronos glTF 2.0.0,
/// KHR_mesh_quantization, EXT_mesh_gpu_instancing, KHR_texture_transform. Internal to core/scene, and to the import of
/// MVR scenery.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// The triangles of the file's scene, with nodes and instances placed, in metres and +Y up. Skins and morphs stay in
/// their bind pose. Refuses extensions that change geometry and are not supported (Draco, meshopt), by name. `file` is
/// for messages.
[[nodiscard]] Checked<PolygonMesh> read_gltf(std::string bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
