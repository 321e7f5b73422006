#pragma once
/// Strict reader of PLY files. Internal to core/scene.

#include <filesystem>

#include "core/result.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Reads ascii and both binary forms, with the vertices' red, green and blue (as sRGB). Skips other elements and
/// properties. Memory stays within a small multiple of the file's size. Problems have the line of the header, or of an
/// ascii body.
[[nodiscard]] Checked<PolygonMesh> read_ply(const std::filesystem::path& path);

}  // namespace luxrig
