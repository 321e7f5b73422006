#include "core/scene/object_scene.h"

#include <limits>
#include <string>

#include "core/text/nearest.h"

namespace luxrig {
namespace {

/// One mark per object, 1 = the one asked for.
Result<std::vector<std::uint8_t>> marks_of_object(const Scene& scene, std::string_view name) {
  std::vector<std::uint8_t> marks;
  bool found = false;
  for (const std::string& known : scene.object_names) {
    marks.push_back(known == name);
    found = found || known == name;
  }
  if (found) return marks;
  // "scene" is the mesh of the whole room, if there is one. A person asks for an object in it.
  std::vector<std::string_view> names;
  for (std::size_t i = 1; i < scene.object_names.size(); ++i) names.push_back(scene.object_names[i]);
  return refusal("there is no object \"" + std::string(name) +
                 "\": " + mend_for_unknown(name, names, "add one with [[scene.object]]"));
}

/// Index of each used entry among those kept; kDropped = not kept.
constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();

}  // namespace

Result<Scene> object_scene(const Scene& scene, std::string_view name) {
  const auto marks = marks_of_object(scene, name);
  if (!marks) return tl::unexpected(marks.error());
  Scene object;
  object.object_names = {std::string(name)};
  Eigen::AlignedBox3d bounds_m;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if (!(*marks)[scene.object_of_triangle[t]]) continue;
    for (const std::uint32_t vertex : scene.triangles[t]) bounds_m.extend(scene.vertices_m[vertex].cast<double>());
  }
  const Vec3 middle_m = bounds_m.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(bounds_m.center());
  object.origin_world_m = scene.origin_world_m + middle_m;
  std::vector<std::uint32_t> kept_vertex(scene.vertices_m.size(), kDropped),
      kept_material(scene.materials.size(), kDropped);
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if (!(*marks)[scene.object_of_triangle[t]]) continue;
    auto triangle = scene.triangles[t];
    for (std::uint32_t& vertex : triangle) {
      std::uint32_t& kept = kept_vertex[vertex];
      if (kept == kDropped) {
        kept = static_cast<std::uint32_t>(object.vertices_m.size());
        object.vertices_m.push_back((scene.vertices_m[vertex].cast<double>() - middle_m).cast<float>());
      }
      vertex = kept;
    }
    object.triangles.push_back(triangle);
    const std::uint32_t material = scene.material_of_triangle[t];
    if (kept_material[material] == kDropped) {
      kept_material[material] = static_cast<std::uint32_t>(object.materials.size());
      object.materials.push_back(scene.materials[material]);
    }
    object.material_of_triangle.push_back(kept_material[material]);
    object.object_of_triangle.push_back(0);
  }
  return object;
}

Result<Scene> scene_without_object(const Scene& scene, std::string_view name) {
  const auto marks = marks_of_object(scene, name);
  if (!marks) return tl::unexpected(marks.error());
  Scene rest = scene;
  rest.triangles.clear();
  rest.material_of_triangle.clear();
  rest.object_of_triangle.clear();
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if ((*marks)[scene.object_of_triangle[t]]) continue;
    rest.triangles.push_back(scene.triangles[t]);
    rest.material_of_triangle.push_back(scene.material_of_triangle[t]);
    rest.object_of_triangle.push_back(scene.object_of_triangle[t]);
  }
  return rest;
}

}  // namespace luxrig
