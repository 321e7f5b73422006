#include "tools/bench/rooms/solid_model.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr std::uint32_t kBoxFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

Triangles box_triangles() {
  Triangles triangles;
  for (const auto& f : kBoxFaces) triangles.insert(triangles.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
  return triangles;
}

std::vector<Vec3> box_corners_m(const Vec3& low_m, const Vec3& high_m) {
  std::vector<Vec3> v;
  for (int i = 0; i < 8; ++i)
    v.emplace_back(i & 1 ? high_m.x() : low_m.x(), i & 2 ? high_m.y() : low_m.y(), i & 4 ? high_m.z() : low_m.z());
  return v;
}

double volume_m3(const std::vector<Vec3>& v, const Triangles& triangles) {
  double six = 0;
  for (const auto& [a, b, c] : triangles) six += (v[a] - v[0]).dot((v[b] - v[0]).cross(v[c] - v[0]));
  return six / 6;
}

}  // namespace

SolidModel::MaterialIndex SolidModel::material(const std::string& name, const Vec3& reflectance_rgb,
                                               double specular_reflectance, double roughness) {
  Material material;
  material.name = name;
  material.reflectance_rgb = reflectance_rgb;
  material.specular_reflectance = specular_reflectance;
  material.roughness = roughness;
  material.coloured = true;
  scene_.materials.push_back(material);
  return static_cast<MaterialIndex>(scene_.materials.size() - 1);
}

void SolidModel::begin_object(const std::string& name) { scene_.object_names.push_back(name); }

void SolidModel::closed(const std::vector<Vec3>& vertices_m, Triangles triangles, MaterialIndex material) {
  if (volume_m3(vertices_m, triangles) < 0)
    for (auto& t : triangles) std::swap(t[1], t[2]);
  append(vertices_m, triangles, material);
}

void SolidModel::append(const std::vector<Vec3>& vertices_m, const Triangles& triangles, MaterialIndex material) {
  LUXRIG_CHECK(!scene_.object_names.empty() && material < scene_.materials.size(), "material {}", material);
  const auto first = static_cast<std::uint32_t>(scene_.vertices_m.size());
  for (const Vec3& v : vertices_m) scene_.vertices_m.push_back(v.cast<float>());
  for (const auto& [a, b, c] : triangles) scene_.triangles.push_back({first + a, first + b, first + c});
  scene_.material_of_triangle.resize(scene_.triangles.size(), material);
  scene_.object_of_triangle.resize(scene_.triangles.size(), static_cast<std::uint32_t>(scene_.object_names.size() - 1));
}

void SolidModel::occupy(const std::vector<Vec3>& vertices_m) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& v : vertices_m) bounds.extend(v);
  occupied_m_.push_back(bounds);
}

void SolidModel::box(const Vec3& low_m, const Vec3& high_m, MaterialIndex material) {
  const std::vector<Vec3> v = box_corners_m(low_m, high_m);
  closed(v, box_triangles(), material);
  occupy(v);
}

void SolidModel::turned_box(const Vec3& base_m, const Vec3& size_m, double turn_rad, MaterialIndex material) {
  const Mat3 turn = Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()).toRotationMatrix();
  std::vector<Vec3> v;
  for (int i = 0; i < 8; ++i)
    v.push_back(base_m + turn * Vec3((i & 1 ? 0.5 : -0.5) * size_m.x(), (i & 2 ? 0.5 : -0.5) * size_m.y(),
                                     i & 4 ? size_m.z() : 0));
  closed(v, box_triangles(), material);
  occupy(v);
}

void SolidModel::wall(const Vec3& low_m, const Vec3& high_m, std::span<const WallGap> gaps, MaterialIndex material) {
  const int along = high_m.x() - low_m.x() > high_m.y() - low_m.y() ? 0 : 1;
  double from_m = low_m[along];
  const auto part = [&](double a_m, double b_m, double bottom_m, double top_m) {
    if (!(b_m > a_m && top_m > bottom_m)) return;
    Vec3 low = low_m, high = high_m;
    low[along] = a_m, high[along] = b_m, low.z() = bottom_m, high.z() = top_m;
    box(low, high, material);
  };
  for (const WallGap& gap : gaps) {
    LUXRIG_CHECK(gap.from_m >= from_m && gap.to_m <= high_m[along], "gap {}…{}", gap.from_m, gap.to_m);
    part(from_m, gap.from_m, low_m.z(), high_m.z());
    part(gap.from_m, gap.to_m, low_m.z(), gap.bottom_m);
    part(gap.from_m, gap.to_m, gap.top_m, high_m.z());
    from_m = gap.to_m;
  }
  part(from_m, high_m[along], low_m.z(), high_m.z());
}

void SolidModel::ring(const double low[2], const double high[2], const double hole_low[2], const double hole_high[2],
                      double bottom_m, double top_m, MaterialIndex material) {
  box({low[0], low[1], bottom_m}, {high[0], hole_low[1], top_m}, material);
  box({low[0], hole_high[1], bottom_m}, {high[0], high[1], top_m}, material);
  box({low[0], hole_low[1], bottom_m}, {hole_low[0], hole_high[1], top_m}, material);
  box({hole_high[0], hole_low[1], bottom_m}, {high[0], hole_high[1], top_m}, material);
}

void SolidModel::shell(const Vec3& low, const Vec3& high, double thickness_m, MaterialIndex floor,
                       MaterialIndex ceiling, const std::array<MaterialIndex, 4>& walls) {
  const double t = thickness_m, w = 0.9 * t, half = 0.5 * t;
  box({low.x() - t, low.y() - t, low.z() - t}, {high.x() + t, high.y() + t, low.z()}, floor);
  box({low.x() - t, low.y() - t, high.z()}, {high.x() + t, high.y() + t, high.z() + t}, ceiling);
  const double bottom = low.z() - half, top = high.z() + half;
  box({low.x() - w, low.y() - half, bottom}, {low.x(), high.y() + half, top}, walls[0]);
  box({high.x(), low.y() - half, bottom}, {high.x() + w, high.y() + half, top}, walls[1]);
  box({low.x() - w, low.y() - w, bottom}, {high.x() + w, low.y(), top}, walls[2]);
  box({low.x() - w, high.y(), bottom}, {high.x() + w, high.y() + w, top}, walls[3]);
}

void SolidModel::body(const ClosedMesh& mesh, MaterialIndex material) {
  closed(mesh.vertices_m, mesh.triangles, material);
  occupy(mesh.vertices_m);
}

void SolidModel::hollow_block(const Vec3& low_m, const Vec3& high_m, const ClosedMesh& cavity, MaterialIndex material) {
  closed(box_corners_m(low_m, high_m), box_triangles(), material);
  Triangles inward = cavity.triangles;
  if (volume_m3(cavity.vertices_m, inward) > 0)
    for (auto& t : inward) std::swap(t[1], t[2]);
  append(cavity.vertices_m, inward, material);
}

void SolidModel::moulding(const HangingPlace& place, double width_m, double height_m, double moulding_m, double depth_m,
                          int profile_points, MaterialIndex material) {
  const auto n = static_cast<std::uint32_t>(profile_points);
  std::vector<Vec3> v;
  constexpr int kCorners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  std::array<std::vector<Vec3>, 4> rings;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::uint32_t i = 0; i < n; ++i) {
      // Half an ellipse with a groove; its foot is 1 cm inside the wall.
      const double angle = kPi * (i + 0.5) / n;
      const double groove = 1 - 0.12 * std::exp(-std::pow((angle - 0.62 * kPi) / 0.12, 2));
      const double outward_m = moulding_m * (0.5 - 0.5 * std::cos(angle));
      const double off_wall_m = depth_m * std::sin(angle) * groove - 0.01;
      rings[c].push_back(place.middle_m + place.right * (kCorners[c][0] * (width_m / 2 + outward_m)) +
                         Vec3::UnitZ() * (kCorners[c][1] * (height_m / 2 + outward_m)) + place.out * off_wall_m);
      v.push_back(rings[c].back());
    }
  Triangles triangles;
  for (std::uint32_t c = 0; c < 4; ++c)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t d = (c + 1) % 4, j = (i + 1) % n;
      triangles.insert(triangles.end(), {{c * n + i, d * n + i, d * n + j}, {c * n + i, d * n + j, c * n + j}});
    }
  closed(v, std::move(triangles), material);
  for (std::size_t c = 0; c < 4; ++c) {
    std::vector<Vec3> side = rings[c];
    side.insert(side.end(), rings[(c + 1) % 4].begin(), rings[(c + 1) % 4].end());
    occupy(side);
  }
}

bool SolidModel::occupied(const Vec3& point_m, double margin_m) const {
  return std::any_of(occupied_m_.begin(), occupied_m_.end(), [&](const Eigen::AlignedBox3d& box) {
    return (point_m.array() >= box.min().array() - margin_m).all() &&
           (point_m.array() <= box.max().array() + margin_m).all();
  });
}

bool SolidModel::open_above(const Vec3& point_m, double headroom_m) const {
  return std::none_of(occupied_m_.begin(), occupied_m_.end(), [&](const Eigen::AlignedBox3d& box) {
    return point_m.x() >= box.min().x() && point_m.x() <= box.max().x() && point_m.y() >= box.min().y() &&
           point_m.y() <= box.max().y() && box.min().z() >= point_m.z() && box.min().z() < point_m.z() + headroom_m;
  });
}

}  // namespace luxrig
