#pragma once
/// Small scenes of sheets, boxes and columns for tests of core/goals.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/scene/ray_scene.h"
#include "tests/random.h"

namespace luxrig {

class BuiltScene {
 public:
  BuiltScene() { scene_.materials.resize(1); }

  BuiltScene& triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(scene_.vertices_m.size());
    for (const Vec3& corner : {a, b, c}) scene_.vertices_m.push_back(corner.cast<float>());
    scene_.triangles.push_back({first, first + 1, first + 2});
    scene_.material_of_triangle.push_back(0);
    scene_.object_of_triangle.push_back(0);
    return *this;
  }
  /// A parallelogram in across × up pieces of two triangles each.
  BuiltScene& sheet(const Vec3& corner, const Vec3& side_a, const Vec3& side_b, int pieces_a = 1, int pieces_b = 1) {
    for (int i = 0; i < pieces_a; ++i)
      for (int j = 0; j < pieces_b; ++j) {
        const auto at = [&](int a, int b) -> Vec3 {
          return corner + side_a * (static_cast<double>(a) / pieces_a) + side_b * (static_cast<double>(b) / pieces_b);
        };
        triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
    return *this;
  }
  BuiltScene& box(const Vec3& low, const Vec3& high) {
    const Vec3 x(high.x() - low.x(), 0, 0), y(0, high.y() - low.y(), 0), z(0, 0, high.z() - low.z());
    sheet(low, x, y).sheet(low, y, z).sheet(low, z, x);
    return sheet(high, -y, -x).sheet(high, -z, -y).sheet(high, -x, -z);
  }
  /// Its shaft only.
  BuiltScene& column(const Vec3& base, double radius_m, double height_m, int segments) {
    const auto at = [&](int i, double z) -> Vec3 {
      const double angle = 2 * kPi * i / segments;
      return base + Vec3(radius_m * std::cos(angle), radius_m * std::sin(angle), z);
    };
    for (int i = 0; i < segments; ++i) {
      triangle(at(i, 0), at(i + 1, 0), at(i + 1, height_m));
      triangle(at(i, 0), at(i + 1, height_m), at(i, height_m));
    }
    return *this;
  }
  /// Triangles anywhere in a cube, some of them without area.
  BuiltScene& clutter(Random& random, int triangles, double size_m) {
    for (int i = 0; i < triangles; ++i) {
      const Vec3 a = size_m * random.in_cube(), b = a + 0.3 * size_m * random.in_cube();
      triangle(a, b, i % 7 == 0 ? a : i % 11 == 0 ? Vec3(0.5 * (a + b)) : Vec3(a + 0.3 * size_m * random.in_cube()));
    }
    return *this;
  }

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
};

/// The same surfaces: triangles in another order, each with its corners in another order.
inline Scene shuffled(const Scene& scene, Random& random) {
  Scene other = scene;
  for (std::size_t i = other.triangles.size(); i > 1; --i) {
    const std::size_t j = random.below(i);
    std::swap(other.triangles[i - 1], other.triangles[j]);
    std::swap(other.material_of_triangle[i - 1], other.material_of_triangle[j]);
    std::swap(other.object_of_triangle[i - 1], other.object_of_triangle[j]);
  }
  for (auto& corners : other.triangles) {
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(random.below(3)), corners.end());
    if (random.below(2) == 0) std::swap(corners[0], corners[1]);
  }
  return other;
}

inline double area_m2(const Scene& scene) {
  double sum = 0;
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertices_m[t[0]].cast<double>();
    sum += 0.5 * (scene.vertices_m[t[1]].cast<double>() - a).cross(scene.vertices_m[t[2]].cast<double>() - a).norm();
  }
  return sum;
}

}  // namespace luxrig
