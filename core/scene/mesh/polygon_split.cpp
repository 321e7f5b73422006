#include "core/scene/mesh/polygon_split.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxrig {
namespace {

using FlatPoint = Eigen::Vector2d;

double turn(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Corner where a quadrilateral's diagonal begins: its reflex corner, if it has one.
std::uint32_t first_corner_of_quad(std::span<const Vec3> p) {
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Vec3 left = (p[(i + 3) % 4] - p[i]).normalized(), across = (p[(i + 2) % 4] - p[i]).normalized(),
               right = (p[(i + 1) % 4] - p[i]).normalized();
    const auto angle_rad = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    if (angle_rad(left.dot(across)) + angle_rad(right.dot(across)) > 3.14159274) return i;  // π as a float
  }
  return 0;
}

/// Projected to the plane of the polygon's area, counter-clockwise.
std::vector<FlatPoint> flattened(std::span<const Vec3> points) {
  Vec3 normal = Vec3::Zero();  // Newell's
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 a = points[i] - points[0], b = points[(i + 1) % points.size()] - points[0];
    normal += a.cross(b);
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<FlatPoint> flat;
  flat.reserve(points.size());
  for (const Vec3& p : points) {
    const Vec3 from_first = p - points[0];
    flat.emplace_back(normal[axis] < 0 ? FlatPoint(from_first[v], from_first[u])
                                       : FlatPoint(from_first[u], from_first[v]));
  }
  return flat;
}

}  // namespace

void split_polygon(std::span<const Vec3> points, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (points.size() == 3) {
    triangles.push_back({0, 1, 2});
    return;
  }
  if (points.size() == 4) {
    const std::uint32_t i = first_corner_of_quad(points);
    triangles.push_back({i, (i + 1) % 4, (i + 2) % 4});
    triangles.push_back({i, (i + 2) % 4, (i + 3) % 4});
    return;
  }
  // Cuts off ears one after another: convex corners whose triangle contains no other corner.
  const std::vector<FlatPoint> flat = flattened(points);
  std::vector<std::uint32_t> open(points.size());
  std::iota(open.begin(), open.end(), 0u);
  std::size_t at = 0, tried = 0;
  while (open.size() > 3) {
    const std::size_t n = open.size();
    const std::uint32_t before = open[(at + n - 1) % n], here = open[at], after = open[(at + 1) % n];
    const FlatPoint &a = flat[before], &b = flat[here], &c = flat[after];
    bool ear = turn(a, b, c) > 0;
    for (std::size_t i = 0; ear && i < n; ++i) {
      if (open[i] == before || open[i] == here || open[i] == after) continue;
      const FlatPoint& p = flat[open[i]];
      if (p == a || p == b || p == c) continue;
      ear = !(turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0);
    }
    if (!ear && ++tried < n) {
      at = (at + 1) % n;
      continue;
    }
    triangles.push_back({before, here, after});  // an ear, or if there is none, the present corner
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(at));
    at = at % open.size();
    tried = 0;
  }
  triangles.push_back({open[0], open[1], open[2]});
}

}  // namespace luxrig
