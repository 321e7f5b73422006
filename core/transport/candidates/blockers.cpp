#include "core/transport/candidates/blockers.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Margins in e (ray_scene.h). Wider than needed: RayScene::occluded() stops 1 e short of the far end and passes
/// triangles within 2 e of it.
constexpr double kErrorsBehind = 64;
constexpr double kErrorsBeside = 8;

struct Side {
  std::uint64_t ends;
  std::uint32_t triangle, corner;  ///< the opposite corner
};

Vec3 corner_m(const Scene& scene, std::uint32_t triangle, std::uint32_t k) {
  return scene.vertex_world_m(scene.triangles[triangle][k]);
}

double area_m2(const Scene& scene, std::uint32_t t) {
  return 0.5 *
         (corner_m(scene, t, 1) - corner_m(scene, t, 0)).cross(corner_m(scene, t, 2) - corner_m(scene, t, 0)).norm();
}

/// The quadrilateral of two triangles across their common edge, if it is flat and convex.
bool join(const Scene& scene, const Side& a, const Side& b, double flat_m, FlatBlocker& quad) {
  const Vec3 p = corner_m(scene, a.triangle, a.corner), q = corner_m(scene, a.triangle, (a.corner + 1) % 3);
  const Vec3 r = corner_m(scene, b.triangle, b.corner), s = corner_m(scene, a.triangle, (a.corner + 2) % 3);
  const Vec3 normal = (q - p).cross(s - p).normalized();
  if (!normal.allFinite() || std::abs(normal.dot(r - p)) > flat_m) return false;
  quad.corners_world_m = {p, q, r, s};
  quad.sides = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 before = quad.corners_world_m[k] - quad.corners_world_m[(k + 3) % 4];
    const Vec3 after = quad.corners_world_m[(k + 1) % 4] - quad.corners_world_m[k];
    if (!(normal.dot(before.cross(after)) > 0)) return false;
  }
  return true;
}

}  // namespace

Blockers::Blockers(const Scene& scene) : blocker_of_triangle_(scene.triangles.size(), ~0u) {
  const auto count = static_cast<std::uint32_t>(scene.triangles.size());
  std::vector<Side> sides;
  sides.reserve(3 * scene.triangles.size());
  Eigen::AlignedBox3d bounds_m;
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      bounds_m.extend(scene.vertices_m[scene.triangles[t][k]].cast<double>());
      const auto [a, b] = std::minmax(scene.triangles[t][(k + 1) % 3], scene.triangles[t][(k + 2) % 3]);
      sides.push_back({static_cast<std::uint64_t>(a) << 32 | b, t, k});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle; });
  // Flat to float rounding.
  const double flat_m =
      count == 0 ? 0 : 0x1p-22 * bounds_m.min().cwiseAbs().cwiseMax(bounds_m.max().cwiseAbs()).maxCoeff();
  struct Pair {
    double area_m2;
    std::size_t side;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].ends == sides[i + 1].ends)
      pairs.push_back({area_m2(scene, sides[i].triangle) + area_m2(scene, sides[i + 1].triangle), i});
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.area_m2 > b.area_m2; });
  for (const Pair& pair : pairs) {
    const Side &a = sides[pair.side], &b = sides[pair.side + 1];
    if (blocker_of_triangle_[a.triangle] != ~0u || blocker_of_triangle_[b.triangle] != ~0u) continue;
    FlatBlocker quad;
    if (!join(scene, a, b, flat_m, quad)) continue;
    blocker_of_triangle_[a.triangle] = blocker_of_triangle_[b.triangle] = static_cast<std::uint32_t>(blockers_.size());
    blockers_.push_back(quad);
  }
  for (std::uint32_t t = 0; t < count; ++t)
    if (blocker_of_triangle_[t] == ~0u) {
      blocker_of_triangle_[t] = static_cast<std::uint32_t>(blockers_.size());
      blockers_.push_back({{corner_m(scene, t, 0), corner_m(scene, t, 1), corner_m(scene, t, 2), Vec3::Zero()}, 3});
    }
}

BlockerShadow::BlockerShadow(const FlatBlocker& blocker, const Vec3& from_world_m, double error_m) {
  const auto& corners = blocker.corners_world_m;
  Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  double height_m = normal.dot(corners[0] - from_world_m);
  if (height_m < 0) normal = -normal, height_m = -height_m;
  // So near its plane that rays may pass it, or seen edge-on: it hides nothing with certainty.
  if (!(height_m > kErrorsBehind * error_m)) return;
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t k = 0; k < blocker.sides; ++k) middle += corners[k] / blocker.sides;
  inward_[0] = normal;
  min_m_[0] = normal.dot(corners[0]) + kErrorsBehind * error_m;
  for (std::uint32_t k = 0; k < blocker.sides; ++k) {
    const Vec3 a = corners[k] - from_world_m, b = corners[(k + 1) % blocker.sides] - from_world_m;
    Vec3 inward = a.cross(b).normalized();
    if (inward.dot(middle - from_world_m) < 0) inward = -inward;
    if (!inward.allFinite()) return;
    inward_[k + 1] = inward;
    // A point behind the plane is at least as far from this side of the shadow as its ray's crossing of the plane. To
    // require several e at the crossing, the test must scale with depth: the ray crosses at the share height / (height
    // + depth) of its length. Done in hides_box().
    min_m_[k + 1] = inward.dot(from_world_m);
  }
  planes_ = blocker.sides + 1;
  height_m_ = height_m;
  beside_m_ = kErrorsBeside * error_m;
}

bool BlockerShadow::hides_box(const Vec3& low_world_m, const Vec3& high_world_m) const {
  if (planes_ == 0) return false;
  // Least and largest product of a vector with the box's corners.
  const auto least = [&](const Vec3& n) {
    return std::min(n.x() * low_world_m.x(), n.x() * high_world_m.x()) +
           std::min(n.y() * low_world_m.y(), n.y() * high_world_m.y()) +
           std::min(n.z() * low_world_m.z(), n.z() * high_world_m.z());
  };
  if (!(least(inward_[0]) > min_m_[0])) return false;
  const double depth_m = -least(-inward_[0]) - min_m_[0];
  const double beside_m = beside_m_ * (1 + depth_m / height_m_);
  for (std::uint32_t k = 1; k < planes_; ++k)
    if (!(least(inward_[k]) > min_m_[k] + beside_m)) return false;
  return true;
}

}  // namespace luxrig
