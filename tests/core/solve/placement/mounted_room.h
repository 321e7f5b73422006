#pragma once
/// A room of 4 × 3 × 2.5 m with named floor, ceiling and walls.

#include <array>
#include <utility>

#include "core/scene/scene.h"

namespace luxrig {

inline Scene mounted_room() {
  Scene scene;
  scene.object_names = {"scene"};
  const auto add = [&](const char* material, const std::array<Vec3f, 4>& corners) {
    const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
    scene.vertices_m.insert(scene.vertices_m.end(), corners.begin(), corners.end());
    scene.materials.push_back(Material{.name = material});
    for (const auto& triangle : {std::array{first, first + 1, first + 2}, std::array{first, first + 2, first + 3}}) {
      scene.triangles.push_back(triangle);
      scene.material_of_triangle.push_back(static_cast<std::uint32_t>(scene.materials.size() - 1));
      scene.object_of_triangle.push_back(0);
    }
  };
  const auto at = [](float x, float y, float z) { return Vec3f(x, y, z); };
  add("floor", {at(0, 0, 0), at(4, 0, 0), at(4, 3, 0), at(0, 3, 0)});
  add("ceiling", {at(0, 0, 2.5f), at(0, 3, 2.5f), at(4, 3, 2.5f), at(4, 0, 2.5f)});
  add("wall south", {at(0, 0, 0), at(0, 0, 2.5f), at(4, 0, 2.5f), at(4, 0, 0)});
  add("wall north", {at(0, 3, 0), at(4, 3, 0), at(4, 3, 2.5f), at(0, 3, 2.5f)});
  add("wall west", {at(0, 0, 0), at(0, 3, 0), at(0, 3, 2.5f), at(0, 0, 2.5f)});
  add("wall east", {at(4, 0, 0), at(4, 0, 2.5f), at(4, 3, 2.5f), at(4, 3, 0)});
  return scene;
}

}  // namespace luxrig
