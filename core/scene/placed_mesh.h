#pragma once
/// A mesh in place, not yet rounded: float keeps only what is relative to a scene's origin, and that is chosen when all
/// of a scene is there. Internal to core/scene, and to the import of MVR scenery.

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

/// Of what its triangles use.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const PlacedMesh& mesh);

/// Adds it to a scene whose origin is set, its vertices rounded to float. Warnings stay behind.
void append_rounded(const PlacedMesh& mesh, std::uint32_t object, Scene& scene);

}  // namespace luxrig
