#pragma once
/// The parts of load_mesh(), for meshes that lie in an archive or are placed among others. Internal to core/scene, and
/// to the import of MVR.

#include <filesystem>
#include <string>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/mesh_file.h"
#include "core/scene/mesh/polygon_mesh.h"
#include "core/scene/placed_mesh.h"

namespace luxrig {

/// In lower case, without its dot.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

/// Any format but PLY, by the extension (in lower case). `file` is for the messages.
[[nodiscard]] Checked<PolygonMesh> read_mesh(std::string bytes, const std::string& extension, const std::string& file,
                                             const FilesBeside& beside);

/// Placed, split into triangles and cleaned; may be left without any.
[[nodiscard]] PlacedMesh place_mesh(PolygonMesh mesh, const Eigen::Affine3d& world_from_mesh);

/// load_mesh() before anything is rounded. Refuses likewise.
[[nodiscard]] Checked<PlacedMesh> load_placed_mesh(const MeshFile& file);

}  // namespace luxrig
