#pragma once
/// A mesh in place, not yet rounded to float. Float needs the scene's origin, which is chosen when the whole scene is
/// known. Internal to core/scene, and to the import of MVR scenery.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace luxrig {

struct PlacedMesh {
  std::vector<Vec3> vertices_world_m;  ///< finite
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> material_of_triangle;
  std::vector<Material> materials;
  Cleaning cleaning;
  std::vector<std::string> warnings;
};

/// Bounds of the vertices that its triangles use.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const PlacedMesh& mesh);

/// Adds the mesh to a scene whose origin is set. Rounds its vertices to float. Does not copy warnings.
void append_rounded(const PlacedMesh& mesh, std::uint32_t object, Scene& scene);

}  // namespace luxrig
