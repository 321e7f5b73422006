#include "core/photometry/shapes/shape_sampling.h"

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_kinds.h"

namespace luxrig {
namespace {

/// Calls `ask` with the shape as its own type; returns `none` for a point.
template <class Answer, class Ask>
Answer by_kind(const LuminousShape& shape, Answer none, Ask&& ask) {
  const Vec3 half_m = 0.5 * shape.size_m;
  switch (shape.kind) {
    case LuminousShape::Kind::point:
      return none;
    case LuminousShape::Kind::rectangle:
      return ask(Rectangle{half_m.x(), half_m.y()});
    case LuminousShape::Kind::disk:
      return ask(Disk{half_m.x()});
    case LuminousShape::Kind::sphere:
      return ask(Ball{half_m.x()});
    case LuminousShape::Kind::cylinder:
      return ask(Cylinder{half_m.x(), half_m.z()});
  }
  return none;
}

double area_m2(const Rectangle& of, const Vec3& d) { return 4 * of.half_x_m * of.half_y_m * std::abs(d.z()); }
double area_m2(const Disk& of, const Vec3& d) { return kPi * of.radius_m * of.radius_m * std::abs(d.z()); }
double area_m2(const Ball& of, const Vec3&) { return kPi * of.radius_m * of.radius_m; }
double wall_area_m2(const Cylinder& of, const Vec3& d) {
  return 4 * of.radius_m * of.half_length_m * std::hypot(d.x(), d.y());
}
double area_m2(const Cylinder& of, const Vec3& d) { return wall_area_m2(of, d) + area_m2(Disk{of.radius_m}, d); }

Vec3 place_m(const Rectangle& of, const Vec3&, double u, double v) {
  return {(2 * u - 1) * of.half_x_m, (2 * v - 1) * of.half_y_m, 0};
}

Vec3 place_m(const Disk& of, const Vec3&, double u, double v) {
  const OnUnitDisk at = concentric(u, v);
  const double radius_m = of.radius_m * std::sqrt(at.radius_squared);
  return {radius_m * at.cos_angle, radius_m * at.sin_angle, 0};
}

Vec3 place_m(const Ball& of, const Vec3& direction, double u, double v) {
  const OnUnitDisk at = concentric(u, v);
  const Vec3 x = direction.unitOrthogonal(), y = direction.cross(x);
  const double radius = std::sqrt(at.radius_squared);
  return of.radius_m *
         (radius * (at.cos_angle * x + at.sin_angle * y) + std::sqrt(std::max(0.0, 1 - at.radius_squared)) * direction);
}

Vec3 place_m(const Cylinder& of, const Vec3& direction, double u, double v) {
  const double wall_m2 = wall_area_m2(of, direction), all_m2 = area_m2(of, direction);
  const double wall_share = all_m2 > 0 ? wall_m2 / all_m2 : 0;
  if (u < wall_share) {
    const double sine = 2 * (u / wall_share) - 1, cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
    const double across = std::hypot(direction.x(), direction.y());
    const double x = direction.x() / across, y = direction.y() / across;
    return {of.radius_m * (cosine * x - sine * y), of.radius_m * (cosine * y + sine * x),
            (2 * v - 1) * of.half_length_m};
  }
  Vec3 place = place_m(Disk{of.radius_m}, direction, wall_share < 1 ? (u - wall_share) / (1 - wall_share) : 0, v);
  place.z() = std::copysign(of.half_length_m, direction.z());
  return place;
}

double way_m(const Rectangle&, const Vec3& from_m, const Vec3& d) { return -from_m.z() / d.z(); }
double way_m(const Disk&, const Vec3& from_m, const Vec3& d) { return -from_m.z() / d.z(); }
double way_m(const Ball& of, const Vec3& from_m, const Vec3& d) {
  const double towards_m = -from_m.dot(d), miss_m = from_m.cross(d).norm();
  return towards_m - std::sqrt(std::max(0.0, (of.radius_m - miss_m) * (of.radius_m + miss_m)));
}
double way_m(const Cylinder& of, const Vec3& from_m, const Vec3& d) {
  // Through the near end if the ray hits it; else on to the wall.
  const double end_m = (-std::copysign(of.half_length_m, d.z()) - from_m.z()) / d.z();
  if (end_m > 0 && std::hypot(from_m.x() + end_m * d.x(), from_m.y() + end_m * d.y()) <= of.radius_m) return end_m;
  const double across2 = d.x() * d.x() + d.y() * d.y();
  const double towards = -(from_m.x() * d.x() + from_m.y() * d.y()) / across2;
  const double miss_m = (from_m.x() * d.y() - from_m.y() * d.x()) / std::sqrt(across2);
  return towards - std::sqrt(std::max(0.0, (of.radius_m - miss_m) * (of.radius_m + miss_m)) / across2);
}

}  // namespace

double projected_area_m2(const LuminousShape& shape, const Vec3& direction_lamp) {
  return by_kind(shape, 0.0, [&](const auto& kind) { return area_m2(kind, direction_lamp); });
}

ShapeSample sample_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m, double u, double v) {
  const ShapeSample sample =
      by_kind(shape, ShapeSample{}, [&](const auto& kind) { return sample_seen_from(kind, point_lamp_m, u, v); });
  // Sizes and distances whose squares exceed the range of double fill no relevant solid angle.
  if (!std::isfinite(sample.density_per_sr) || !(sample.distance_m > 0) || !sample.direction.allFinite()) return {};
  return sample;
}

double density_seen_from(const LuminousShape& shape, const Vec3& point_lamp_m, const Vec3& direction_lamp) {
  const double density =
      by_kind(shape, 0.0, [&](const auto& kind) { return density_seen_from(kind, point_lamp_m, direction_lamp); });
  return std::isfinite(density) ? density : 0;
}

double distance_towards_m(const LuminousShape& shape, const Vec3& point_lamp_m, const Vec3& direction_lamp) {
  return by_kind(shape, 0.0, [&](const auto& kind) { return way_m(kind, point_lamp_m, direction_lamp); });
}

Vec3 sample_leaving_place_m(const LuminousShape& shape, const Vec3& direction_lamp, double u, double v) {
  return by_kind(shape, Vec3(Vec3::Zero()), [&](const auto& kind) { return place_m(kind, direction_lamp, u, v); });
}

}  // namespace luxrig
