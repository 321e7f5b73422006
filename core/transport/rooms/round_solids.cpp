/// The round ones of SolidModel's solids, as meshes.

#include <cmath>

#include "core/check.h"
#include "core/transport/rooms/solid_model.h"

namespace luxrig {

void SolidModel::turned_body(const Vec3& base_m, std::span<const Eigen::Vector2d> profile_m, int segments,
                             MaterialIndex material, int flutes, double depth) {
  LUXRIG_CHECK(profile_m.size() >= 2 && segments >= 3, "{} rings of {}", profile_m.size(), segments);
  const auto n = static_cast<std::uint32_t>(segments), rings = static_cast<std::uint32_t>(profile_m.size());
  std::vector<Vec3> v;
  for (const Eigen::Vector2d& at : profile_m)
    for (std::uint32_t s = 0; s < n; ++s) {
      const double angle = 2 * kPi * s / n, radius_m = at.x() * (1 + depth * std::cos(flutes * angle));
      v.push_back(base_m + Vec3(radius_m * std::cos(angle), radius_m * std::sin(angle), at.y()));
    }
  const std::uint32_t bottom = rings * n, top = bottom + 1;
  v.push_back(base_m + Vec3(0, 0, profile_m.front().y()));
  v.push_back(base_m + Vec3(0, 0, profile_m.back().y()));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t s = 0; s < n; ++s) {
    const std::uint32_t next = (s + 1) % n, last = (rings - 1) * n;
    triangles.push_back({bottom, next, s});
    triangles.push_back({top, last + s, last + next});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      triangles.push_back({r * n + s, r * n + next, (r + 1) * n + next});
      triangles.push_back({r * n + s, (r + 1) * n + next, (r + 1) * n + s});
    }
  }
  closed(v, std::move(triangles), material);
  occupy(v);
}

void SolidModel::column(const Vec3& base_m, double radius_m, double height_m, int segments, MaterialIndex material) {
  const std::vector<Eigen::Vector2d> profile = {{radius_m, 0}, {radius_m, height_m}};
  turned_body(base_m, profile, segments, material);
}

void SolidModel::ball(const Vec3& centre_m, double radius_m, int segments, MaterialIndex material) {
  std::vector<Eigen::Vector2d> profile;
  const int rings = segments / 2;
  for (int i = 0; i < rings; ++i) {
    const double polar = kPi * (i + 0.5) / rings;
    profile.emplace_back(radius_m * std::sin(polar), -radius_m * std::cos(polar));
  }
  turned_body(centre_m, profile, segments, material);
}

void SolidModel::knot(const Vec3& centre_m, double size_m, int along, int around, MaterialIndex material) {
  const double radius_m = 0.22 * size_m;
  const auto torus_m = [&](double t) {
    const double ring_m = size_m * (1 + 0.5 * std::cos(3 * t));
    return Vec3(ring_m * std::cos(2 * t), ring_m * std::sin(2 * t), 0.5 * size_m * std::sin(3 * t));
  };
  std::vector<Vec3> v;
  for (int i = 0; i < along; ++i) {
    const double t = 2 * kPi * i / along;
    const Vec3 tangent = (torus_m(t + 1e-4) - torus_m(t - 1e-4)).normalized();
    // The normal of the torus that the knot winds on closes on itself, unlike a frame carried along the curve.
    const Vec3 outward(std::cos(3 * t) * std::cos(2 * t), std::cos(3 * t) * std::sin(2 * t), std::sin(3 * t));
    const Vec3 side = tangent.cross(outward).normalized(), normal = side.cross(tangent);
    for (int j = 0; j < around; ++j) {
      const double angle = 2 * kPi * j / around;
      v.push_back(centre_m + torus_m(t) + radius_m * (std::cos(angle) * normal + std::sin(angle) * side));
    }
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto n = static_cast<std::uint32_t>(along), m = static_cast<std::uint32_t>(around);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const std::uint32_t a = i * m + j, b = i * m + (j + 1) % m, c = (i + 1) % n * m + (j + 1) % m,
                          d = (i + 1) % n * m + j;
      triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
    }
  closed(v, std::move(triangles), material);
  occupy(v);
}

}  // namespace luxrig
