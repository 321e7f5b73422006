#pragma once
/// glTF 2.0, .gltf and .glb, read here: from strangers, so every bound is checked. Source: Khronos glTF 2.0.0,
/// KHR_mesh_quantization, EXT_mesh_gpu_instancing, KHR_texture_transform. Internal to core/scene, and to the import of
/// MVR scenery.

#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// The triangles of the file's scene, nodes and instances placed, in metres and +Y up. Skins and morphs stay as they
/// are bound. Refuses by name what an extension does to geometry and is not known here (Draco, meshopt). `file` is for
/// the messages.
[[nodiscard]] Checked<PolygonMesh> read_gltf(std::string bytes, const std::string& file, const FilesBeside& beside);

}  // namespace luxrig
