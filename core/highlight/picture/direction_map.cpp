#include "core/highlight/picture/direction_map.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

DirectionMap::DirectionMap(const Vec3& towards_viewer) {
  LUXRIG_CHECK(towards_viewer.norm() > 0, "no direction");
  front_ = towards_viewer.normalized();
  const Vec3 up_hint = std::abs(front_.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ();
  right_ = up_hint.cross(front_).normalized();
  up_ = front_.cross(right_);
}

DirectionMap::MapPoint DirectionMap::place_of(const Vec3& direction) const {
  const Vec3 d = direction.normalized();
  MapPoint place;
  place.behind = d.dot(front_) < 0;
  // √2 sin(θ/2) = sin θ / √(1 + cos θ): on the rim, at 90°, it is 1.
  const double scale = 1 / std::sqrt(1 + std::abs(d.dot(front_)));
  place.x = scale * d.dot(right_);
  place.y = scale * d.dot(up_);
  return place;
}

Vec3 DirectionMap::direction_at(const MapPoint& place) const {
  const double radius = std::hypot(place.x, place.y), within = radius > 1 ? 1 / radius : 1;
  const double x = place.x * within, y = place.y * within;
  const double square = std::min(1.0, x * x + y * y);
  const double across = std::sqrt(2 - square);  // sin θ / r
  const double along = (place.behind ? -1 : 1) * (1 - square);
  return (across * (x * right_ + y * up_) + along * front_).normalized();
}

}  // namespace luxrig
