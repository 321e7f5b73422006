#pragma once
/// PLY files, read here: the reader of assimp 5.2.5 reads past its buffers on broken headers and bodies, which nothing
/// after it can catch. Internal to mesh_file.cpp.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"

namespace luxrig {

inline constexpr std::size_t kMaxCorners = 1000;  ///< of one face; splitting it takes the square of this

/// What a PLY says of its shape, as it stands there: indices may point past the vertices, vertices may be NaN.
struct PlyMesh {
  std::vector<Vec3f> vertices;               ///< in the file's unit
  std::vector<std::uint32_t> corners;        ///< vertex indices, face after face; a negative one is 2^32 - 1
  std::vector<std::uint32_t> corner_counts;  ///< of each face, at most kMaxCorners
};

/// Reads ascii and both binary forms; other elements and properties are skipped. Memory stays within a small multiple
/// of the file's size. Problems carry the line of the header, or of an ascii body.
[[nodiscard]] Checked<PlyMesh> read_ply(const std::filesystem::path& path);

}  // namespace luxrig
