#include "core/scene/placed_mesh.h"

namespace luxrig {

Eigen::AlignedBox3d bounds_of(const PlacedMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) bounds.extend(mesh.vertices_world_m[index]);
  }
  return bounds;
}

void append_rounded(const PlacedMesh& mesh, std::uint32_t object, Scene& scene) {
  const auto vertex_base = static_cast<std::uint32_t>(scene.vertices_m.size());
  const auto material_base = static_cast<std::uint32_t>(scene.materials.size());
  scene.vertices_m.reserve(vertex_base + mesh.vertices_world_m.size());
  for (const Vec3& vertex : mesh.vertices_world_m)
    scene.vertices_m.push_back((vertex - scene.origin_world_m).cast<float>());
  for (auto triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) index += vertex_base;
    scene.triangles.push_back(triangle);
  }
  for (const std::uint32_t material : mesh.material_of_triangle)
    scene.material_of_triangle.push_back(material_base + material);
  scene.object_of_triangle.insert(scene.object_of_triangle.end(), mesh.triangles.size(), object);
  scene.materials.insert(scene.materials.end(), mesh.materials.begin(), mesh.materials.end());
  scene.cleaning.non_finite_vertices += mesh.cleaning.non_finite_vertices;
  scene.cleaning.bad_indices += mesh.cleaning.bad_indices;
  scene.cleaning.degenerate_triangles += mesh.cleaning.degenerate_triangles;
}

}  // namespace luxrig
