#include "core/transport/candidates/visible_points.h"

#include <algorithm>

namespace luxrig {

bool VisiblePoints::wholly_behind(const PointTree::Node& node) const {
  const Vec3& n = from_.normal_world;
  const Vec3 low_m = node.low_m - from_.position_world_m, high_m = node.high_m - from_.position_world_m;
  return n.cwiseProduct(low_m).cwiseMax(n.cwiseProduct(high_m)).sum() <= 0;
}

bool VisiblePoints::wholly_out_of_reach(const PointTree::Node& node) const {
  const Vec3& p = from_.position_world_m;
  const double nearest_m2 = (p.cwiseMax(node.low_m).cwiseMin(node.high_m) - p).squaredNorm();
  return peak_cd_ < min_lux_ * nearest_m2;
}

bool VisiblePoints::hidden(const PointTree::Node& node) {
  for (const Remembered& r : remembered_)
    if (r.shadow.hides_box(node.low_m, node.high_m)) return true;
  if (node.right == 0) return false;  // a test ray could save at most as many rays again
  const Vec3 towards_m = (node.low_m + node.high_m) / 2 - from_.position_world_m;
  const double distance_m = towards_m.norm();
  if (!(distance_m > 0)) return false;
  ++rays;
  const auto hit = scene_.rays->nearest(from_.position_world_m, towards_m / distance_m, from_.normal_world);
  if (!hit || hit->distance_m >= distance_m) return false;
  const std::uint32_t blocker = scene_.blockers->index_of_triangle(hit->triangle);
  for (const Remembered& r : remembered_)
    if (r.blocker == blocker) return false;
  const double error_m =
      std::max(scene_.rays->surface_error_m(from_.position_world_m),
               std::max(scene_.rays->surface_error_m(node.low_m), scene_.rays->surface_error_m(node.high_m)));
  Remembered& place = remembered_[oldest_++ % kRemembered];
  place = {blocker, BlockerShadow(scene_.blockers->of_triangle(hit->triangle), from_.position_world_m, error_m)};
  return place.shadow.hides_box(node.low_m, node.high_m);
}

}  // namespace luxrig
