#include "core/scene/shaft.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxrig {
namespace {

constexpr std::uint32_t kLeaf = 4;

void add_plane(Shaft& shaft, const Vec3& through_m, const Vec3& normal, const Vec3& inside_m) {
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  Vec3 inwards = normal / length;
  if (inwards.dot(inside_m - through_m) < 0) inwards = -inwards;
  shaft.planes.push_back({inwards, inwards.dot(through_m)});
}

}  // namespace

Shaft shaft_to_quad(const Vec3& from_world_m, const Vec3& normal_world, std::span<const Vec3, 4> corners_world_m) {
  Shaft shaft;
  const auto& c = corners_world_m;
  const Vec3 middle_m = 0.25 * (c[0] + c[1] + c[2] + c[3]);
  shaft.planes.push_back({normal_world, normal_world.dot(from_world_m)});
  for (std::size_t i = 0; i < 4; ++i)
    add_plane(shaft, from_world_m, (c[i] - from_world_m).cross(c[(i + 1) % 4] - from_world_m), middle_m);
  add_plane(shaft, middle_m, (c[2] - c[0]).cross(c[3] - c[1]), from_world_m);
  shaft.corners_world_m.assign(c.begin(), c.end());
  shaft.corners_world_m.push_back(from_world_m);
  return shaft;
}

Shaft shaft_to_hull(const Vec3& from_world_m, const Vec3& normal_world, std::span<const Vec3> corners_world_m) {
  Shaft shaft;
  Vec3 middle_m = Vec3::Zero();
  for (const Vec3& corner : corners_world_m) middle_m += corner / static_cast<double>(corners_world_m.size());
  const Vec3 axis = (middle_m - from_world_m).normalized();
  // Sides perpendicular to the hull's first edge, so that long shapes get narrow shafts.
  const Vec3 edge = corners_world_m[1] - corners_world_m[0];
  Vec3 u = edge - edge.dot(axis) * axis;
  u = u.norm() > 1e-6 * edge.norm() ? Vec3(u.normalized()) : axis.unitOrthogonal();
  const Vec3 v = axis.cross(u);
  double farthest_m = 0;
  Vec3 low(HUGE_VAL, HUGE_VAL, 0), high(-HUGE_VAL, -HUGE_VAL, 0);
  for (const Vec3& corner : corners_world_m) {
    const Vec3 way_m = corner - from_world_m;
    const double forward_m = way_m.dot(axis);
    if (!(forward_m > 1e-3 * way_m.norm())) return {};
    farthest_m = std::max(farthest_m, forward_m);
    const Vec3 slope(way_m.dot(u) / forward_m, way_m.dot(v) / forward_m, 0);
    low = low.cwiseMin(slope);
    high = high.cwiseMax(slope);
  }
  shaft.planes.push_back({normal_world, normal_world.dot(from_world_m)});
  for (int side = 0; side < 2; ++side) {
    const Vec3& across = side == 0 ? u : v;
    add_plane(shaft, from_world_m, across - low[side] * axis, from_world_m + axis + (low[side] + 1) * across);
    add_plane(shaft, from_world_m, high[side] * axis - across, from_world_m + axis + (high[side] - 1) * across);
  }
  add_plane(shaft, from_world_m + farthest_m * axis, -axis, from_world_m);
  // The hull itself, not the pyramid's base, since light leaves only from the hull.
  shaft.corners_world_m.assign(corners_world_m.begin(), corners_world_m.end());
  shaft.corners_world_m.push_back(from_world_m);
  return shaft;
}

bool hull_lies_behind(const Vec3& from_m, std::span<const Vec3> corners_m,
                      std::span<const std::array<Vec3, 3>> triangles_m, std::span<const std::size_t> of_corner) {
  // A triangle's cone is convex, so everything between corners behind the same triangle is behind it.
  const auto behind = [&](const std::array<Vec3, 3>& t, const Vec3& p) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double of_point = normal.dot(p - t[0]), of_from = normal.dot(from_m - t[0]);
    return of_point * of_from < 0;
  };
  for (std::size_t i = 0; i < corners_m.size(); ++i)
    if (!behind(triangles_m[of_corner[i]], corners_m[i])) return false;
  if (triangles_m.size() == 1) return true;
  const Vec3 first = triangles_m[0][0] - from_m, second = triangles_m[0][1] - from_m;
  const Vec3 across = first.cross(second);  // normal of the plane through the point and the shared edge
  const double side0 = across.dot(triangles_m[0][2] - from_m), side1 = across.dot(triangles_m[1][2] - from_m);
  if (!(side0 * side1 < 0)) return false;  // folded over, or seen edge-on
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    for (std::size_t j = 0; j < corners_m.size(); ++j) {
      if (of_corner[i] != 0 || of_corner[j] != 1) continue;
      const double at_i = across.dot(corners_m[i] - from_m), at_j = across.dot(corners_m[j] - from_m);
      if (!(at_i * at_j < 0)) return false;
      const Vec3 crossing_m = corners_m[i] + at_i / (at_i - at_j) * (corners_m[j] - corners_m[i]);
      const Vec3 way = crossing_m - from_m;
      const bool between = first.cross(way).dot(across) > 0 && way.cross(second).dot(across) > 0;
      if (!between || !behind(triangles_m[0], crossing_m) || !behind(triangles_m[1], crossing_m)) return false;
    }
  }
  return true;
}

TriangleTree::TriangleTree(std::span<const Vec3f> vertices_m, std::span<const std::array<std::uint32_t, 3>> triangles,
                           const Vec3& origin_world_m)
    : vertices_m_(vertices_m), triangles_(triangles), origin_world_m_(origin_world_m) {
  if (triangles.empty()) return;
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  middles_m_.reserve(triangles.size());
  for (const auto& t : triangles) middles_m_.push_back((vertices_m[t[0]] + vertices_m[t[1]] + vertices_m[t[2]]) / 3);
  nodes_.reserve(triangles.size());
  build(0, static_cast<std::uint32_t>(triangles.size()));
  middles_m_ = {};
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t at = nodes_.size();
  Eigen::AlignedBox3f bounds, middles;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const std::uint32_t vertex : triangles_[order_[i]]) bounds.extend(vertices_m_[vertex]);
    middles.extend(middles_m_[order_[i]]);
  }
  nodes_.push_back({bounds.min(), bounds.max(), begin, end, 0});
  if (end - begin <= kLeaf) return;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;  // halves, so that equal triangles do not nest deep
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float of_a = middles_m_[a][axis], of_b = middles_m_[b][axis];
                     return of_a != of_b ? of_a < of_b : a < b;
                   });
  build(begin, middle);
  nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

bool TriangleTree::keeps_out_of(const Shaft& shaft, double within_m) const {
  if (nodes_.empty()) return true;
  if (shaft.corners_world_m.empty()) return false;
  std::vector<Vec3> corners_m;
  for (const Vec3& corner : shaft.corners_world_m) corners_m.push_back(corner - origin_world_m_);
  std::vector<Shaft::Plane> planes = shaft.planes;
  for (Shaft::Plane& plane : planes) plane.distance_m += within_m - plane.inwards.dot(origin_world_m_);
  Eigen::AlignedBox3d bounds;
  for (const Vec3& corner : corners_m) bounds.extend(corner);

  const auto box_apart = [&](const Node& node) {
    const Vec3 low = node.low_m.cast<double>(), high = node.high_m.cast<double>();
    if ((low.array() > bounds.max().array()).any() || (high.array() < bounds.min().array()).any()) return true;
    for (const Shaft::Plane& plane : planes) {
      double most = 0;
      for (int k = 0; k < 3; ++k) most += plane.inwards[k] * (plane.inwards[k] > 0 ? high[k] : low[k]);
      if (most <= plane.distance_m) return true;
    }
    return false;
  };
  const auto triangle_apart = [&](const std::array<std::uint32_t, 3>& triangle) {
    const Vec3 a = vertices_m_[triangle[0]].cast<double>(), b = vertices_m_[triangle[1]].cast<double>(),
               c = vertices_m_[triangle[2]].cast<double>();
    for (const Shaft::Plane& plane : planes)
      if (std::max({plane.inwards.dot(a), plane.inwards.dot(b), plane.inwards.dot(c)}) <= plane.distance_m) return true;
    const Vec3 normal = (b - a).cross(c - a);
    const double length = normal.norm();
    if (!(length > 0)) return false;
    double most = -HUGE_VAL, least = HUGE_VAL;
    for (const Vec3& corner : corners_m) {
      const double above_m = normal.dot(corner - a) / length;
      most = std::max(most, above_m);
      least = std::min(least, above_m);
    }
    return most <= within_m || least >= -within_m;
  };

  // Depth first; a tree of halves is at most 33 deep.
  std::array<std::uint32_t, 64> todo;
  std::size_t count = 0;
  todo[count++] = 0;
  while (count > 0) {
    const std::uint32_t at = todo[--count];
    const Node& node = nodes_[at];
    if (box_apart(node)) continue;
    if (node.right != 0) {
      todo[count++] = node.right;
      todo[count++] = at + 1;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (!triangle_apart(triangles_[order_[i]])) return false;
  }
  return true;
}

}  // namespace luxrig
