#include "tools/bench/highlight/variants.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/check.h"
#include "core/highlight/surface/target_surface.h"

namespace luxrig {
namespace {

constexpr const char* kVariantKinds[] = {"rotate", "translate", "scale", "decimate", "noise"};
constexpr double kVariantNoise = 0.001;

/// Welded vertices and triangles as a scene of one object.
Scene scene_of_surface(const Scene& object, const std::vector<Vec3>& points_m,
                       std::vector<std::array<std::uint32_t, 3>> triangles) {
  Scene scene;
  scene.origin_world_m = object.origin_world_m;
  for (const Vec3& p : points_m) scene.vertices_m.push_back(p.cast<float>());
  scene.triangles = std::move(triangles);
  scene.materials.resize(1);
  scene.object_names = {"variant"};
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  return scene;
}

TargetSurface surface_of_object(const Scene& object) {
  auto surface = make_target_surface(object);
  LUXRIG_CHECK(surface, "{}", surface.error().detail);
  return std::move(*surface);
}

using MeshTriangle = std::array<std::uint32_t, 3>;

Vec3 doubled_area(const MeshTriangle& t, const std::vector<Vec3>& points_m) {
  return (points_m[t[1]] - points_m[t[0]]).cross(points_m[t[2]] - points_m[t[0]]);
}

/// One pass: collapses edges whose surroundings have no point in common.
std::size_t collapse_short_edges(std::vector<Vec3>& points_m, std::vector<MeshTriangle>& triangles,
                                 std::size_t wanted) {
  std::vector<std::vector<std::uint32_t>> of_point(points_m.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      of_point[triangles[t][k]].push_back(t);
      edges.push_back(std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]));
    }
  std::sort(edges.begin(), edges.end());
  // Only inner edges between two triangles: an open border keeps its shape.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inner;
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j - i == 2) inner.push_back(edges[i]);
  }
  std::vector<std::uint8_t> on_border(points_m.size(), 0), touched(points_m.size(), 0);
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j - i != 2) on_border[edges[i].first] = on_border[edges[i].second] = 1;
  }
  std::stable_sort(inner.begin(), inner.end(), [&](const auto& a, const auto& b) {
    return (points_m[a.first] - points_m[a.second]).squaredNorm() <
           (points_m[b.first] - points_m[b.second]).squaredNorm();
  });
  // The shortest third only: the next pass sorts the rest again.
  inner.resize((inner.size() + 2) / 3);

  const auto neighbours = [&](std::uint32_t point) {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t t : of_point[point])
      for (const std::uint32_t p : triangles[t])
        if (p != point) all.push_back(p);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  };
  std::vector<std::uint8_t> gone(triangles.size(), 0);
  std::size_t removed = 0;
  for (const auto& [a, b] : inner) {
    if (removed >= wanted) break;
    if (touched[a] || touched[b] || on_border[a] || on_border[b]) continue;
    const auto of_a = neighbours(a), of_b = neighbours(b);
    std::vector<std::uint32_t> both;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(both));
    if (both.size() != 2) continue;  // else two sheets would be glued together
    const auto is_touched = [&](std::uint32_t p) { return touched[p] != 0; };
    if (std::ranges::any_of(of_a, is_touched) || std::ranges::any_of(of_b, is_touched)) continue;
    const Vec3 old_a = points_m[a], old_b = points_m[b], middle = (old_a + old_b) / 2;
    bool turns = false;
    for (const std::uint32_t end : {a, b}) {
      for (const std::uint32_t t : of_point[end]) {
        if (std::ranges::count(triangles[t], a) + std::ranges::count(triangles[t], b) == 2) continue;
        const Vec3 before = doubled_area(triangles[t], points_m);
        const Vec3 kept = std::exchange(points_m[end], middle), after = doubled_area(triangles[t], points_m);
        points_m[end] = kept;
        turns |= !(before.dot(after) > 0.5 * before.norm() * after.norm());
      }
    }
    if (turns) continue;
    for (const std::uint32_t p : of_a) touched[p] = 1;
    for (const std::uint32_t p : of_b) touched[p] = 1;
    points_m[a] = middle;
    for (const std::uint32_t t : of_point[b]) {
      if (std::ranges::count(triangles[t], a) > 0) {
        gone[t] = 1;
        ++removed;
      } else {
        std::ranges::replace(triangles[t], b, a);
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!gone[t]) triangles[kept++] = triangles[t];
  triangles.resize(kept);
  return removed;
}

}  // namespace

std::span<const char* const> highlight_variant_kinds() { return kVariantKinds; }

Scene decimated(const Scene& object, std::size_t triangles) {
  TargetSurface surface = surface_of_object(object);
  while (surface.triangles.size() > triangles &&
         collapse_short_edges(surface.points_m, surface.triangles, surface.triangles.size() - triangles) > 0) {
  }
  return scene_of_surface(object, surface.points_m, std::move(surface.triangles));
}

HighlightVariant highlight_variant(const Scene& object, const std::string& kind) {
  HighlightVariant variant{object, Mat3::Identity()};
  std::vector<Vec3f>& vertices_m = variant.scene.vertices_m;
  if (kind == "rotate") {
    variant.rotation = Eigen::AngleAxisd(rad_from_deg(67), Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
    for (Vec3f& v : vertices_m) v = (variant.rotation * v.cast<double>()).cast<float>();
  } else if (kind == "translate") {
    Eigen::AlignedBox3d box;
    for (const Vec3f& v : vertices_m) box.extend(v.cast<double>());
    variant.scene.origin_world_m += box.diagonal().norm() * Vec3(412.3, -271.8, 31.4);
    for (Vec3f& v : vertices_m) v += (0.37 * box.diagonal()).cast<float>();
  } else if (kind == "scale") {
    for (Vec3f& v : vertices_m) v *= 0.01f;
    variant.scene.origin_world_m *= 0.01;
  } else if (kind == "decimate") {
    variant.scene = decimated(object, object.triangles.size() / 2);
  } else {
    LUXRIG_CHECK(kind == "noise", "{}", kind);
    TargetSurface surface = surface_of_object(object);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal(0, kVariantNoise * surface.diagonal_m());
    for (std::size_t i = 0; i < surface.points_m.size(); ++i)
      surface.points_m[i] += normal(random) * surface.normals[i];
    variant.scene = scene_of_surface(object, surface.points_m, std::move(surface.triangles));
  }
  return variant;
}

}  // namespace luxrig
