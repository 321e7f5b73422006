// What a brush covers: the patches near a piece of its path, as far as links lead from the path without leaving its
// width. So a brush beside a wall stays on its side.
#include <algorithm>
#include <cmath>

#include "core/goals/painting.h"

namespace luxrig {
namespace {

double distance_m(const Vec3& place, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp((place - from).dot(along) / length2, 0.0, 1.0) : 0;
  return (place - (from + share * along)).norm();
}

/// Falls smoothly from 1 to 0 over the outer part of the radius.
float weight_at(double distance_m, const Stroke& stroke) {
  const double full_m = stroke.radius_m * (1 - stroke.falloff);
  if (distance_m <= full_m) return 1;
  const double t = (stroke.radius_m - distance_m) / (stroke.radius_m - full_m);
  return static_cast<float>(t * t * (3 - 2 * t));
}

}  // namespace

std::vector<Painting::Covered> Painting::brushed_along(const Stroke& stroke, const SurfacePlace& from,
                                                       const SurfacePlace& to) const {
  std::vector<Covered> covered;
  const auto meet = [&](const SurfacePlace& place) {
    const auto patch = patch_at(surface_, rays_, place);
    if (!patch || marked_[*patch]) return;
    marked_[*patch] = 1;
    covered.push_back({*patch, 1});
  };
  meet(from);
  meet(to);
  for (std::size_t i = 0; i < covered.size(); ++i)
    for (const PatchLink& link : surface_.links_of(covered[i].patch)) {
      if (marked_[link.patch]) continue;
      const double away_m =
          distance_m(surface_.position_world_m(link.patch), from.position_world_m, to.position_world_m);
      if (away_m >= stroke.radius_m) continue;
      marked_[link.patch] = 1;
      covered.push_back({link.patch, weight_at(away_m, stroke)});
    }
  for (const Covered& one : covered) marked_[one.patch] = 0;
  std::sort(covered.begin(), covered.end(), [](const Covered& a, const Covered& b) { return a.patch < b.patch; });
  return covered;
}

}  // namespace luxrig
