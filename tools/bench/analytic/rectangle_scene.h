#pragma once
/// Scenes of flat rectangles without thickness, for closed forms.

#include "core/scene/scene.h"

namespace luxrig {

class RectangleScene {
 public:
  /// corner, corner + u, corner + u + v, corner + v; diffuse and grey.
  void add(const Vec3& corner_m, const Vec3& u_m, const Vec3& v_m, double reflectance) {
    std::uint32_t material = 0;
    while (material < scene_.materials.size() && scene_.materials[material].reflectance_rgb.x() != reflectance)
      ++material;
    if (material == scene_.materials.size()) {
      scene_.materials.emplace_back();
      scene_.materials.back().name = "grey";
      scene_.materials.back().reflectance_rgb = Vec3::Constant(reflectance);
    }
    const auto first = static_cast<std::uint32_t>(scene_.vertices_m.size());
    for (const Vec3& corner : {corner_m, Vec3(corner_m + u_m), Vec3(corner_m + u_m + v_m), Vec3(corner_m + v_m)})
      scene_.vertices_m.push_back(corner.cast<float>());
    scene_.triangles.insert(scene_.triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    scene_.material_of_triangle.resize(scene_.triangles.size(), material);
    scene_.object_of_triangle.resize(scene_.triangles.size(), 0);
  }

  /// The six faces of a box.
  void add_box(const Vec3& low_m, const Vec3& high_m, double reflectance) {
    const Vec3 size_m = high_m - low_m;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1})
        add(low_m + side * size_m[axis] * Vec3::Unit(axis), size_m[(axis + 1) % 3] * Vec3::Unit((axis + 1) % 3),
            size_m[(axis + 2) % 3] * Vec3::Unit((axis + 2) % 3), reflectance);
  }

  [[nodiscard]] Scene scene() const {
    Scene scene = scene_;
    scene.object_names = {"scene"};
    return scene;
  }

 private:
  Scene scene_;
};

}  // namespace luxrig
