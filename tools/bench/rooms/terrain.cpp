#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

/// -1 … 1, the same for the same lattice point.
double lattice_value(std::int64_t x, std::int64_t y, std::uint64_t seed) {
  std::uint64_t h = seed + static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ull +
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full;
  for (int round = 0; round < 2; ++round) h = (h ^ h >> 31) * 0xBF58476D1CE4E5B9ull;
  return static_cast<double>(h >> 11) * 0x1p-52 - 1;
}

/// Smooth between the lattice's values.
double lattice_noise(double x, double y, std::uint64_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto smooth = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double u = smooth(x - fx), v = smooth(y - fy);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  return (1 - u) * (1 - v) * lattice_value(i, j, seed) + u * (1 - v) * lattice_value(i + 1, j, seed) +
         (1 - u) * v * lattice_value(i, j + 1, seed) + u * v * lattice_value(i + 1, j + 1, seed);
}

}  // namespace

Scene make_terrain(double side_m, int split, std::uint64_t seed) {
  LUXRIG_CHECK(side_m > 0 && split > 0, "{} m in {}", side_m, split);
  Scene scene;
  for (int i = 0; i <= split; ++i) {
    for (int j = 0; j <= split; ++j) {
      const double x = static_cast<double>(i) / split, y = static_cast<double>(j) / split;
      double height = 0, amplitude = 0.085, frequency = 3;
      for (std::uint64_t octave = 0; octave < 5; ++octave) {
        // |noise| has creases at 0: sharp valleys.
        height += amplitude * std::abs(lattice_noise(frequency * x, frequency * y, seed * 31 + octave));
        amplitude *= 0.45;
        frequency *= 2.1;
      }
      scene.vertices_m.push_back(Vec3(side_m * (x - 0.5), side_m * (y - 0.5), side_m * height).cast<float>());
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (split + 1) + j); };
  for (int i = 0; i < split; ++i) {
    for (int j = 0; j < split; ++j) {
      scene.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      scene.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  scene.materials = {Material{}};
  scene.materials.front().name = "ground";
  scene.object_names = {"terrain"};
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  return scene;
}

}  // namespace luxrig
