#pragma once
/// Boxes made of triangles, for rooms and the objects in them.

#include <array>

#include "core/scene/scene.h"

namespace luxrig {

inline void add_box(Scene& scene, const Vec3& low_m, const Vec3& high_m, std::uint32_t material = 0) {
  const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
  for (int i = 0; i < 8; ++i)
    scene.vertices_m.push_back(
        Vec3(i & 1 ? high_m.x() : low_m.x(), i & 2 ? high_m.y() : low_m.y(), i & 4 ? high_m.z() : low_m.z())
            .cast<float>());
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces)
    for (const auto& t : {std::array{f[0], f[1], f[2]}, std::array{f[0], f[2], f[3]}}) {
      scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      scene.material_of_triangle.push_back(material);
      scene.object_of_triangle.push_back(0);
    }
  scene.object_names = {"scene"};
}

}  // namespace luxrig
