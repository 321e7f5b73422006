#include "core/calibration/mount_place.h"

#include <algorithm>
#include <optional>

namespace luxrig {
namespace {

/// From a lamp's place to the surface behind it, unless it is stated to be nearer.
constexpr double kClear_m = 0.02;

}  // namespace

Vec3 offset_in_room(const RayScene& room, const Vec3& stated_world_m, const Vec3& offset_m) {
  // The surface that is in the way, if any is.
  const auto in_the_way = [&](const Vec3& offset) -> std::optional<Hit> {
    const double length_m = offset.norm();
    if (!(length_m > 0)) return std::nullopt;
    auto hit = room.nearest(stated_world_m, offset / length_m, Vec3::Zero());
    if (!hit || hit->distance_m > length_m) return std::nullopt;
    return hit;
  };
  const auto hit = in_the_way(offset_m);
  if (!hit) return offset_m;
  const Vec3 ahead = offset_m.normalized();
  const Vec3& back = hit->normal_world;
  const double stated_before_m = -back.dot(ahead) * hit->distance_m;
  const double before_m = stated_before_m + back.dot(offset_m);
  const Vec3 slid_m = offset_m + back * (std::min(kClear_m, stated_before_m) - before_m);
  if (!in_the_way(slid_m)) return slid_m;
  return ahead * std::max(0.0, hit->distance_m - kClear_m);
}

}  // namespace luxrig
