#include "tools/bench/rooms/enclosures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace luxrig {
namespace {

Scene scene_of(std::vector<Vec3f> vertices_m, std::vector<std::array<std::uint32_t, 3>> triangles, double reflectance) {
  Scene scene;
  scene.vertices_m = std::move(vertices_m);
  scene.triangles = std::move(triangles);
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  scene.materials = {{"wall", Vec3::Constant(reflectance)}};
  scene.object_names = {"scene"};
  return scene;
}

std::array<Vec3, 3> corners_m(const Scene& scene, std::size_t triangle) {
  const auto& t = scene.triangles[triangle];
  return {scene.vertex_world_m(t[0]), scene.vertex_world_m(t[1]), scene.vertex_world_m(t[2])};
}

/// A normal with the area as its length.
Vec3 area_normal_m2(const Scene& scene, std::size_t triangle) {
  const auto [a, b, c] = corners_m(scene, triangle);
  return 0.5 * (b - a).cross(c - a);
}

}  // namespace

Scene make_cube(double edge_m, double reflectance) {
  std::vector<Vec3f> vertices_m;
  for (int i = 0; i < 8; ++i)
    vertices_m.push_back((Vec3((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5) * edge_m).cast<float>());
  std::vector<std::array<std::uint32_t, 3>> triangles;
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    triangles.push_back({f[0], f[1], f[2]});
    triangles.push_back({f[0], f[2], f[3]});
  }
  return scene_of(std::move(vertices_m), std::move(triangles), reflectance);
}

Scene make_icosphere(double radius_m, int splits, double reflectance) {
  const double g = std::numbers::phi;
  std::vector<Vec3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& p : points) p.normalize();
  std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                         {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                         {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                         {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int s = 0; s < splits; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle_of_edge;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, added] =
          middle_of_edge.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (added) points.push_back((points[a] + points[b]).normalized());
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(4 * triangles.size());
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  std::vector<Vec3f> vertices_m;
  vertices_m.reserve(points.size());
  for (const Vec3& p : points) vertices_m.push_back((radius_m * p).cast<float>());
  return scene_of(std::move(vertices_m), std::move(triangles), reflectance);
}

std::vector<WallPoint> cube_wall_grid(double edge_m, int per_edge) {
  std::vector<WallPoint> points;
  const double step_m = edge_m / per_edge;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i < per_edge; ++i)
        for (int j = 0; j < per_edge; ++j) {
          Vec3 position_m = side * edge_m / 2 * Vec3::Unit(axis);
          position_m[(axis + 1) % 3] = (i + 0.5) * step_m - edge_m / 2;
          position_m[(axis + 2) % 3] = (j + 0.5) * step_m - edge_m / 2;
          points.push_back({position_m, -side * Vec3::Unit(axis)});
        }
  return points;
}

double area_m2(const Scene& scene) {
  double sum_m2 = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) sum_m2 += area_normal_m2(scene, t).norm();
  return sum_m2;
}

std::vector<WallPoint> spread_over_walls(const Scene& scene, std::size_t count, const Vec3& inside_m) {
  std::vector<double> area_up_to_m2;
  double sum_m2 = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t)
    area_up_to_m2.push_back(sum_m2 += area_normal_m2(scene, t).norm());
  std::vector<WallPoint> points;
  for (std::size_t i = 0; i < count && sum_m2 > 0; ++i) {
    // Stratified along the area; within the triangle by folding the unit square into it.
    const double at_m2 = sum_m2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const auto found = std::upper_bound(area_up_to_m2.begin(), area_up_to_m2.end(), at_m2);
    const auto t = static_cast<std::size_t>(found - area_up_to_m2.begin());
    const auto [a, b, c] = corners_m(scene, t);
    // Additive recurrence with powers of the plastic number: it fills the square evenly, without bias.
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(i), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(i), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 position_m = a + u * (b - a) + v * (c - a);
    const Vec3 normal = area_normal_m2(scene, t).normalized();
    points.push_back({position_m, normal.dot(inside_m - position_m) < 0 ? Vec3(-normal) : normal});
  }
  return points;
}

double mean_wall_illuminance_lx(double flux_lm, double area_m2, double reflectance) {
  return flux_lm / (area_m2 * (1 - reflectance));
}

double reflected_wall_illuminance_lx(double flux_lm, double area_m2, double reflectance) {
  return reflectance * mean_wall_illuminance_lx(flux_lm, area_m2, reflectance);
}

}  // namespace luxrig
