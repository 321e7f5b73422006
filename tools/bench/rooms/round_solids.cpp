/// The round solids of SolidModel, as meshes.

#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/solid_model.h"

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

void SolidModel::arch(const Vec3& low, const Vec3& high, double pier_m, int segments, MaterialIndex material) {
  const int along = high.x() - low.x() > high.y() - low.y() ? 0 : 1, across = 1 - along;
  const double length_m = high[along] - low[along], radius_m = length_m / 2 - pier_m;
  LUXRIG_CHECK(pier_m > 0 && radius_m > 0 && high.z() - low.z() > radius_m && segments >= 2, "pier {} m", pier_m);
  // The underside from end to end: along the arch, with heights above low.z().
  std::vector<Eigen::Vector2d> under_m = {{0, 0}};
  for (int s = 0; s <= segments; ++s) {
    const double angle = kPi * s / segments;
    under_m.emplace_back(pier_m + radius_m * (1 - std::cos(angle)),
                         s == 0 || s == segments ? 0 : radius_m * std::sin(angle));
  }
  under_m.emplace_back(length_m, 0);
  // Four corners per station: under and top, on the near and the far face.
  std::vector<Vec3> v;
  const auto stations = static_cast<std::uint32_t>(under_m.size());
  for (const Eigen::Vector2d& at : under_m)
    for (const double y : {low[across], high[across]})
      for (const double z : {low.z() + at.y(), high.z()}) {
        Vec3 corner(0, 0, z);
        corner[along] = low[along] + at.x(), corner[across] = y;
        v.push_back(corner);
      }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
  };
  // Corners of a station: 0 near under, 1 near top, 2 far under, 3 far top.
  for (std::uint32_t i = 0; i + 1 < stations; ++i) {
    const std::uint32_t a = 4 * i, b = a + 4;
    quad(a, b, b + 1, a + 1);
    quad(a + 2, a + 3, b + 3, b + 2);
    quad(a, a + 2, b + 2, b);
    quad(a + 1, b + 1, b + 3, a + 3);
    occupy({v.begin() + a, v.begin() + b + 4});
  }
  const std::uint32_t last = 4 * (stations - 1);
  quad(0, 1, 3, 2);
  quad(last, last + 2, last + 3, last + 1);
  closed(v, std::move(triangles), material);
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
    // The normal of the torus under the knot is periodic, unlike a frame carried along the curve.
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
