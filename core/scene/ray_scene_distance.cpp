// Distance to the nearest surface: Embree finds the triangles; distances are computed in double.
#include <algorithm>
#include <limits>

#include "core/check.h"
#include "core/scene/ray_scene_state.h"

namespace luxrig {
namespace {

/// Closest point of the triangle to p, by the region of its plane that p is over (Ericson, Real-Time Collision
/// Detection, 5.1.5).
Vec3 closest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  if (!(sum > 0)) return a;  // no area, missed above through rounding
  return a + vb / sum * ab + vc / sum * ac;
}

}  // namespace

struct RayScene::NearestQuery {
  const State* state;
  std::span<const std::uint8_t> wanted;
  Vec3 from_m;
  double squared_m2;
  std::optional<std::uint32_t> triangle;
  Vec3 place_m = Vec3::Zero();

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& self = *static_cast<NearestQuery*>(arguments->userPtr);
    const std::uint32_t t = arguments->primID;
    if (!self.wanted.empty() && !self.wanted[t]) return false;
    const auto& corners = self.state->triangles[t].corners_m;
    const Vec3 place_m = closest_in_triangle(self.from_m, corners[0].cast<double>(), corners[1].cast<double>(),
                                             corners[2].cast<double>());
    const double squared_m2 = (place_m - self.from_m).squaredNorm();
    // Of equally near ones, the first in the file, whatever the order of traversal.
    if (!(squared_m2 < self.squared_m2 || (squared_m2 == self.squared_m2 && (!self.triangle || t < *self.triangle))))
      return false;
    self.squared_m2 = squared_m2;
    self.triangle = t;
    self.place_m = place_m;
    arguments->query->radius = self.radius();
    return true;
  }

  /// Slightly more than the distance, so that rounding hides no surface that is as near.
  [[nodiscard]] float radius() const {
    return static_cast<float>(std::sqrt(squared_m2) * (1 + 1e-5) + 2 * state->error_m(from_m));
  }
};

std::optional<NearestSurface> RayScene::nearest_surface(const Vec3& from_world_m, double within_m,
                                                        std::span<const std::uint8_t> of_triangles) const {
  const State& state = *state_;
  LUXRIG_CHECK(from_world_m.allFinite() && within_m >= 0, "within {} m", within_m);
  LUXRIG_CHECK(of_triangles.empty() || of_triangles.size() == state.triangles.size(), "{} marks for {} triangles",
               of_triangles.size(), state.triangles.size());
  if (state.triangles.empty()) return std::nullopt;
  NearestQuery found{&state, of_triangles, from_world_m - state.origin_world_m, within_m * within_m, {}};
  RTCPointQuery query;
  query.x = static_cast<float>(found.from_m.x());
  query.y = static_cast<float>(found.from_m.y());
  query.z = static_cast<float>(found.from_m.z());
  query.time = 0;
  query.radius = found.radius();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(state.scene, &query, &context, &NearestQuery::visit, &found);
  if (!found.triangle) return std::nullopt;
  return NearestSurface{std::sqrt(found.squared_m2), *found.triangle, found.place_m + state.origin_world_m};
}

}  // namespace luxrig
