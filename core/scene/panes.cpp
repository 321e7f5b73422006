#include "core/scene/panes.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace luxrig {
namespace {

constexpr double kFloatGlassIndex = 1.52;
/// Share of the way; two triangles crossed within it are one pane.
constexpr double kSamePlace = 1e-9;

/// Composition of glass with a given transmittance at normal incidence.
struct Glass {
  double index = 1;
  double passage = 1;  ///< share left after one passage straight through
};

Glass glass_of(double at_normal) {
  const double ratio = (kFloatGlassIndex - 1) / (kFloatGlassIndex + 1), r = ratio * ratio;
  if (at_normal >= (1 - r) / (1 + r)) {
    const double root = std::sqrt((1 - at_normal) / (1 + at_normal));  // = (n - 1) / (n + 1)
    return {(1 + root) / (1 - root), 1};
  }
  // Positive root of (1 - r)² a / (1 - r² a²) = T, in the form that keeps its digits for small r.
  const double b = (1 - r) * (1 - r);
  return {kFloatGlassIndex, 2 * at_normal / (b + std::sqrt(b * b + 4 * r * r * at_normal * at_normal))};
}

/// Whether the segment from + t way, t in 0…1, meets the box.
bool meets(const Eigen::AlignedBox3d& box, const Vec3& from, const Vec3& way) {
  double near = 0, far = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0) {
      if (from[axis] < box.min()[axis] || from[axis] > box.max()[axis]) return false;
      continue;
    }
    const double a = (box.min()[axis] - from[axis]) / way[axis], b = (box.max()[axis] - from[axis]) / way[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far * (1 + 1e-12) + 1e-300;
}

}  // namespace

double pane_transmittance(double at_normal, double cosine) {
  const Glass glass = glass_of(at_normal);
  cosine = std::min(std::abs(cosine), 1.0);
  if (cosine == 0) return 0;
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (glass.index * glass.index));
  const double across = (cosine - glass.index * inside) / (cosine + glass.index * inside),
               along = (glass.index * cosine - inside) / (glass.index * cosine + inside);
  const double left = glass.passage < 1 ? std::pow(glass.passage, 1 / inside) : 1.0;
  double sum = 0;
  for (const double r : {across * across, along * along})
    if (r < 1) sum += (1 - r) * (1 - r) * left / (1 - r * r * left * left);
  return std::min(sum / 2, 1.0);
}

Panes::Panes(std::span<const Pane> panes) {
  std::map<std::uint32_t, Object> of_object;
  for (const Pane& pane : panes) {
    const auto& [a, b, c] = pane.corners_world_m;
    const Vec3 normal = (b - a).cross(c - a);
    if (!(normal.squaredNorm() > 0) || !normal.allFinite()) continue;
    Object& object = of_object[pane.object];
    for (const Vec3& corner : pane.corners_world_m) object.box_world_m.extend(corner);
    object.triangles.push_back({pane.corners_world_m, normal.normalized(), pane.transmittance});
  }
  for (auto& [index, object] : of_object) objects_.push_back(std::move(object));
}

double Panes::transmittance(const Vec3& from_world_m, const Vec3& to_world_m, double near_m) const {
  double share = 1;
  const Vec3 way_m = to_world_m - from_world_m;
  const double length_m = way_m.norm();
  if (!(length_m > 0) || !std::isfinite(length_m)) return share;
  const double first = near_m / length_m, last = 1 - first;
  std::vector<double> met;  // allocates nothing until there is a crossing
  for (const Object& object : objects_) {
    if (!meets(object.box_world_m, from_world_m, way_m)) continue;
    met.clear();
    for (const Triangle& triangle : object.triangles) {
      const double along_m = triangle.normal.dot(way_m);
      if (along_m == 0) continue;
      const double at = triangle.normal.dot(triangle.corners_m[0] - from_world_m) / along_m;
      if (!(at > first && at < last)) continue;
      // Inside all three edges, or on one: a shared edge is met by both of its triangles.
      const Vec3 place = from_world_m + at * way_m;
      bool inside = true;
      for (std::size_t i = 0; i < 3 && inside; ++i) {
        const Vec3& a = triangle.corners_m[i];
        const Vec3 edge = triangle.corners_m[(i + 1) % 3] - a;
        const double side = triangle.normal.dot(edge.cross(place - a));
        inside = side >= -1e-12 * edge.norm() * (edge.norm() + (place - a).norm());
      }
      if (!inside || std::any_of(met.begin(), met.end(), [&](double m) { return std::abs(m - at) <= kSamePlace; }))
        continue;
      met.push_back(at);
      share *= pane_transmittance(triangle.transmittance, along_m / length_m);
    }
  }
  return share;
}

}  // namespace luxrig
