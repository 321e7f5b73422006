#pragma once
/// What each triangle of a mesh reflects: its material's colour, times its picture, times its vertices' colours.
/// Internal to core/scene.

#include <map>
#include <vector>

#include "core/scene/mesh/polygon_mesh.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Materials for triangles, made as they are asked for: triangles of one material of the file whose colours are nearly
/// alike share one, which has the mean of their colours by area.
class SurfaceColours {
 public:
  /// `mesh` must outlive this.
  explicit SurfaceColours(const PolygonMesh& mesh);

  /// The index that the triangle of these corners (places in mesh.corners) gets in the materials.
  std::uint32_t material_of(std::uint32_t file_material, const std::array<std::size_t, 3>& corners, double area_m2);

  /// In the order in which they were first used.
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
