#pragma once
/// Reflectance of each triangle of a mesh: its material's colour, times its picture, times its vertex colours. Internal
/// to core/scene.

#include <map>
#include <vector>

#include "core/scene/mesh/polygon_mesh.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Makes materials for triangles on demand. Triangles with the same file material and nearly equal colours share one,
/// with the mean of their colours by area.
class SurfaceColours {
 public:
  /// `mesh` must outlive this.
  explicit SurfaceColours(const PolygonMesh& mesh);

  /// Index in the materials for the triangle with these corners (positions in mesh.corners).
  std::uint32_t material_of(std::uint32_t file_material, const std::array<std::size_t, 3>& corners, double area_m2);

  /// In the order of first use.
  [[nodiscard]] std::vector<Material> take();

 private:
  struct Shade {
    std::uint32_t file_material = 0;
    Vec3 sum = Vec3::Zero();
    double area_m2 = 0;
  };

  const PolygonMesh& mesh_;
  std::vector<FileMaterial> materials_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> shade_of_;  // by material and rounded colour
  std::vector<Shade> shades_;
};

}  // namespace luxrig
