#pragma once
/// Meshes of shapes with curvature known in closed form.

#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "core/scene/scene.h"
#include "tests/random.h"

namespace luxrig {

inline Scene with_one_material(Scene scene) {
  scene.materials.resize(1);
  scene.object_names = {"target"};
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  return scene;
}

/// f(u, v) over [0, 1]² in nu × nv squares of two triangles each, facing ∂u × ∂v. Seams are open: the vertices at 0 and
/// 1 have separate indices.
inline Scene parametric(int nu, int nv, const std::function<Vec3(double, double)>& f) {
  Scene scene;
  for (int i = 0; i <= nu; ++i)
    for (int j = 0; j <= nv; ++j)
      scene.vertices_m.push_back(f(static_cast<double>(i) / nu, static_cast<double>(j) / nv).cast<float>());
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (nv + 1) + j); };
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      scene.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      scene.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return with_one_material(scene);
}

/// Has poles with slivers: rings are evenly spaced in angle.
inline Scene uv_sphere(double radius_m, int rings) {
  return parametric(2 * rings, rings, [=](double u, double v) {
    const double phi = 2 * kPi * (u - std::floor(u)), theta = kPi * (1 - v);
    return Vec3(radius_m * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
  });
}

inline Scene cylinder(double radius_m, double height_m, int around, int along) {
  return parametric(around, along, [=](double u, double v) {
    return Vec3(radius_m * std::cos(2 * kPi * u), radius_m * std::sin(2 * kPi * u), height_m * (v - 0.5));
  });
}

inline Scene torus(double ring_m, double tube_m, int around, int across) {
  return parametric(around, across, [=](double u, double v) {
    const double phi = 2 * kPi * (u - std::floor(u)), theta = 2 * kPi * (v - std::floor(v)),
                 out = ring_m + tube_m * std::cos(theta);
    return Vec3(out * std::cos(phi), out * std::sin(phi), tube_m * std::sin(theta));
  });
}

/// z = (x² - y²) / (2 radius_m) over a square of side 2 · half_m, facing up.
inline Scene saddle(double radius_m, double half_m, int split) {
  return parametric(split, split, [=](double u, double v) {
    const double x = half_m * (2 * u - 1), y = half_m * (2 * v - 1);
    return Vec3(x, y, (x * x - y * y) / (2 * radius_m));
  });
}

/// A ceiling that faces down: half_m to each side of the middle, at the given height.
inline Scene ceiling(double half_m, double height_m, const Vec3& middle_m = Vec3::Zero()) {
  return parametric(2, 2, [=](double u, double v) {
    return Vec3(middle_m + Vec3(half_m * (2 * v - 1), half_m * (2 * u - 1), height_m));
  });
}

inline Scene joined(Scene a, const Scene& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices_m.size());
  a.vertices_m.insert(a.vertices_m.end(), b.vertices_m.begin(), b.vertices_m.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return with_one_material(a);
}

/// Moves every vertex by normal noise along a random direction. Vertices at the same place move alike.
inline Scene noisy(Scene scene, double sigma_m, unsigned seed) {
  Random random(seed);
  std::map<std::array<float, 3>, Vec3f> moved;
  for (Vec3f& v : scene.vertices_m) {
    const std::array<float, 3> key = {v.x() + 0.0f, v.y() + 0.0f, v.z() + 0.0f};
    auto it = moved.find(key);
    if (it == moved.end()) {
      Vec3 noise;
      for (int axis = 0; axis < 3; ++axis)
        noise[axis] =
            sigma_m * std::sqrt(-2 * std::log(random.between(1e-12, 1))) * std::cos(random.between(0, 2 * kPi));
      it = moved.emplace(key, v + noise.cast<float>()).first;
    }
    v = it->second;
  }
  return scene;
}

inline Scene transformed(Scene scene, double scale, const Mat3& rotation, const Vec3& shift_m) {
  for (Vec3f& v : scene.vertices_m) v = (scale * (rotation * v.cast<double>()) + shift_m).cast<float>();
  return scene;
}

/// The same surface with its vertices and triangles in another order.
inline Scene shuffled(const Scene& scene, unsigned seed) {
  Random random(seed);
  std::vector<std::uint32_t> order(scene.vertices_m.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  Scene result = scene;
  for (std::size_t i = 0; i < order.size(); ++i) result.vertices_m[order[i]] = scene.vertices_m[i];
  for (auto& t : result.triangles) t = {order[t[1]], order[t[2]], order[t[0]]};
  for (std::size_t i = result.triangles.size(); i > 1; --i)
    std::swap(result.triangles[i - 1], result.triangles[random.below(i)]);
  return result;
}

}  // namespace luxrig
