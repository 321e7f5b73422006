#pragma once
#include <cmath>
#include <random>

#include "core/scene/ray_scene.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// A grey room on grey ground: 4 m along x, 5 m along y, 3 m high, floor at z = 0. Optional windows in the walls y = 0
/// and y = 5, optional skylight. The whole can be turned about z.
struct RoomWithWindows {
  static constexpr double kWidth_m = 4, kDepth_m = 5, kHeight_m = 3;
  bool roof = true, ground = true;
  std::array<double, 4> near_window_m{}, far_window_m{};  ///< x from, x to, z from, z to; none if empty
  std::array<double, 4> skylight_m{};                     ///< x from, x to, y from, y to
  double reflectance = 0.5, ground_reflectance = 0.2, turned_rad = 0;

  [[nodiscard]] Vec3 world(const Vec3& room_m) const { return Eigen::AngleAxisd(turned_rad, Vec3::UnitZ()) * room_m; }

  [[nodiscard]] Scene scene() const {
    Scene scene;
    scene.object_names = {"room"};
    for (const double rho : {reflectance, ground_reflectance}) {
      scene.materials.emplace_back();
      scene.materials.back().reflectance_rgb = Vec3::Constant(rho);
    }
    const auto add = [&](std::uint32_t material, const Vec3& corner_m, const Vec3& u_m, const Vec3& v_m) {
      if (!(u_m.cross(v_m).norm() > 0)) return;
      const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
      for (const Vec3& at_m : {corner_m, Vec3(corner_m + u_m), Vec3(corner_m + u_m + v_m), Vec3(corner_m + v_m)})
        scene.vertices_m.push_back(world(at_m).cast<float>());
      scene.triangles.insert(scene.triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
      scene.material_of_triangle.resize(scene.triangles.size(), material);
      scene.object_of_triangle.resize(scene.triangles.size(), 0);
    };
    // A wall of size a × b with a hole in it.
    const auto pierced = [&](const Vec3& corner_m, const Vec3& a, double a_m, const Vec3& b, double b_m,
                             const std::array<double, 4>& hole) {
      add(0, corner_m, hole[0] * a, b_m * b);
      add(0, corner_m + hole[1] * a, (a_m - hole[1]) * a, b_m * b);
      add(0, corner_m + hole[0] * a, (hole[1] - hole[0]) * a, hole[2] * b);
      add(0, corner_m + hole[0] * a + hole[3] * b, (hole[1] - hole[0]) * a, (b_m - hole[3]) * b);
    };
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    add(0, {0, 0, 0}, kWidth_m * x, kDepth_m * y);
    add(0, {0, 0, 0}, kDepth_m * y, kHeight_m * z);
    add(0, {kWidth_m, 0, 0}, kDepth_m * y, kHeight_m * z);
    pierced({0, 0, 0}, x, kWidth_m, z, kHeight_m, near_window_m);
    pierced({0, kDepth_m, 0}, x, kWidth_m, z, kHeight_m, far_window_m);
    if (roof) pierced({0, 0, kHeight_m}, x, kWidth_m, y, kDepth_m, skylight_m);
    if (ground) add(1, {-20, -20, -0.2}, {44, 0, 0}, {0, 45, 0});
    return scene;
  }

  /// Three points at desk height and one on the wall x = 0.
  [[nodiscard]] std::vector<Receiver> desks() const {
    std::vector<Receiver> desks;
    for (const double at_y : {0.6, 2.4, 4.4}) desks.push_back({world({1.3, at_y, 0.8}), Vec3::UnitZ()});
    desks.push_back({world({0.001, 3.1, 1.5}), world(Vec3::UnitX())});
    return desks;
  }
};

struct BruteForce {
  double lux = 0, error_lx = 0;
};
/// Illuminance by plain paths that end where they hit nothing, in double. Samples no light source.
inline BruteForce lux_by_plain_paths(const RayScene& rays, const Receiver& receiver, const SkyLuminance& sky, int paths,
                                     std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double sum = 0, squares = 0;
  for (int p = 0; p < paths; ++p) {
    Receiver at = receiver;
    double through = kPi;
    while (true) {
      const double radius = std::sqrt(unit(random)), angle = 2 * kPi * unit(random);
      const Vec3 u = at.normal_world.unitOrthogonal(), v = at.normal_world.cross(u);
      const Vec3 d = (radius * (std::cos(angle) * u + std::sin(angle) * v) +
                      std::sqrt(std::max(0.0, 1 - radius * radius)) * at.normal_world)
                         .normalized();
      const auto hit = rays.nearest(at.position_world_m, d, at.normal_world);
      if (!hit) {
        const double lux = through * sky.luminance_cd_m2(d);
        sum += lux, squares += lux * lux;
        break;
      }
      if (unit(random) >= rays.material_of(hit->triangle).reflectance_rgb.x()) break;
      at = {hit->position_world_m, hit->normal_world};
    }
  }
  const double mean = sum / paths;
  return {mean, std::sqrt(std::max(0.0, squares / paths - mean * mean) / paths)};
}

}  // namespace luxrig
