#pragma once
/// The steps of load_mesh(), for meshes in an archive or placed among others. Internal to core/scene, and to the import
/// of MVR.

#include <filesystem>
#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/mesh_file.h"
#include "core/scene/mesh/polygon_mesh.h"
#include "core/scene/placed_mesh.h"

namespace luxrig {

/// In lower case, without the dot.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

/// Reads any format but PLY, by the extension (in lower case). `file` is for messages.
[[nodiscard]] Checked<PolygonMesh> read_mesh(std::string bytes, const std::string& extension, const std::string& file,
                                             const FilesBeside& beside);

/// Places, splits into triangles and cleans; the result may have no triangles.
[[nodiscard]] PlacedMesh place_mesh(PolygonMesh mesh, const Eigen::Affine3d& world_from_mesh);

/// load_mesh() before rounding. Refuses likewise.
[[nodiscard]] Checked<PlacedMesh> load_placed_mesh(const MeshFile& file);

}  // namespace luxrig
