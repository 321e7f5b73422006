#include "tools/bench/goals/tiled_hall.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kLength_m = 24, kWidth_m = 12, kHeight_m = 5, kRadius_m = 0.35;
constexpr int kAlong = 8, kAcross = 4;

class TiledHall {
 public:
  explicit TiledHall(double edge_m) : edge_m_(edge_m) { scene_.materials.resize(1); }

  /// place   from [0, 1]² to a surface
  template <class Place>
  void surface(double along_m, double across_m, const Place& place) {
    const auto columns = pieces(along_m), rows = pieces(across_m);
    const auto first = static_cast<std::uint32_t>(scene_.vertices_m.size());
    for (std::uint32_t i = 0; i <= columns; ++i)
      for (std::uint32_t j = 0; j <= rows; ++j)
        scene_.vertices_m.push_back(Vec3(place(double(i) / columns, double(j) / rows)).cast<float>());
    for (std::uint32_t i = 0; i < columns; ++i)
      for (std::uint32_t j = 0; j < rows; ++j) {
        const std::uint32_t a = first + i * (rows + 1) + j, b = a + rows + 1;
        scene_.triangles.push_back({a, b, b + 1});
        scene_.triangles.push_back({a, b + 1, a + 1});
      }
  }
  void sheet(const Vec3& corner, const Vec3& along, const Vec3& across) {
    surface(along.norm(), across.norm(), [&](double u, double v) -> Vec3 { return corner + u * along + v * across; });
  }
  void shaft(const Vec3& base) {
    surface(2 * kPi * kRadius_m, kHeight_m, [&](double u, double v) -> Vec3 {
      const double angle = 2 * kPi * u;
      return base + Vec3(kRadius_m * std::cos(angle), kRadius_m * std::sin(angle), v * kHeight_m);
    });
  }
  Scene scene() {
    scene_.material_of_triangle.assign(scene_.triangles.size(), 0);
    scene_.object_of_triangle.assign(scene_.triangles.size(), 0);
    scene_.object_names = {"scene"};
    return std::move(scene_);
  }

 private:
  [[nodiscard]] std::uint32_t pieces(double length_m) const {
    return static_cast<std::uint32_t>(std::max(1.0, std::round(length_m / edge_m_)));
  }

  double edge_m_;
  Scene scene_;
};

}  // namespace

Scene make_tiled_hall(std::size_t triangles) {
  const double area_m2 = 2 * (kLength_m * kWidth_m + kLength_m * kHeight_m + kWidth_m * kHeight_m) +
                         kAlong * kAcross * 2 * kPi * kRadius_m * kHeight_m;
  TiledHall hall(std::sqrt(2 * area_m2 / static_cast<double>(triangles)));
  const Vec3 x(kLength_m, 0, 0), y(0, kWidth_m, 0), z(0, 0, kHeight_m);
  hall.sheet(Vec3::Zero(), x, y);
  hall.sheet(z, x, y);
  for (const Vec3& at : {Vec3(0, 0, 0), y}) hall.sheet(at, x, z);
  for (const Vec3& at : {Vec3(0, 0, 0), x}) hall.sheet(at, y, z);
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAcross; ++j) hall.shaft({kLength_m * (i + 0.5) / kAlong, kWidth_m * (j + 0.5) / kAcross, 0});
  return hall.scene();
}

}  // namespace luxrig
