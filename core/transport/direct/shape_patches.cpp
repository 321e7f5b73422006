/// Coordinates, with the receiver in the origin:
///
/// Plane (strip, disk)   x, y in the plane, h its distance; d² = x² + h², r² = d² + y²; dω = h dx dy / r³. Nearby,
///                       x = h sinh τ and y = d sinh υ, so dω = dτ/cosh τ dυ/cosh² υ. In these coordinates the angles
///                       around the point below the receiver, and light of any intensity there, vary on a scale of 1.
/// Disk                  x = x₀ + R sin t, y = y₀ ± R cos t: this smooths the chord's end points, which have a root at
///                       the rim. x is at right angles to the horizon's line, so the horizon is a limit of t.
/// Ball                  directions √(1-s²) (cos a X + sin a Y) + s Z, with X to the centre and Z in the receiver's
///                       horizon: planes through Z are a = const, including the horizon. With Θ half the angle of the
///                       ball and sin a = sin Θ sin t, |s| ≤ sin Θ cos t / cos a; dω = da ds.
/// Wall (of a cylinder)  azimuth η with sin η = (R/ρ) sin t, elevation by height: dω = dη d² dz / r³; the horizon is a
///                       limit of z.

#include "core/transport/direct/shape_patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace luxrig {
namespace {

/// A shape is far if its radius is less than this share of its distance.
constexpr double kFar = 0.35;

double squared(double x) { return x * x; }

double asin_within(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)); }

/// A coordinate along a line at distance d, from the share w of its limits; and dy/dw · d²/r³, r² = d² + y².
struct Along {
  double y, per_w;
};
Along along_line(const PatchLimits& limits, double d, double w, bool far) {
  if (far) {
    const double y = limits.at(w), r2 = d * d + y * y;
    return {y, limits.width() * d * d / (r2 * std::sqrt(r2))};
  }
  const PatchLimits angle{std::asinh(limits.low / d), std::asinh(limits.high / d)};
  const double y = d * std::sinh(angle.at(w));
  return {y, angle.width() * d * d / (d * d + y * y)};
}

struct Point {
  double x, y;
};

/// Clips a convex polygon to a·x + b·y + c ≥ 0.
std::vector<Point> clipped(const std::vector<Point>& polygon, double a, double b, double c) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double at_p = a * p.x + b * p.y + c, at_q = a * q.x + b * q.y + c;
    if (at_p >= 0) kept.push_back(p);
    if ((at_p >= 0) != (at_q >= 0)) {
      const double share = at_p / (at_p - at_q);
      kept.push_back({p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)});
    }
  }
  return kept;
}

/// Lower and upper y of a convex polygon's outline at x.
PatchLimits outline(const std::vector<Point>& polygon, double x) {
  PatchLimits y{HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    if (x < std::min(p.x, q.x) || x > std::max(p.x, q.x)) continue;
    for (const double share :
         p.x == q.x ? std::array{0.0, 1.0} : std::array{(x - p.x) / (q.x - p.x), (x - p.x) / (q.x - p.x)}) {
      const double at = p.y + std::clamp(share, 0.0, 1.0) * (q.y - p.y);
      y.low = std::min(y.low, at);
      y.high = std::max(y.high, at);
    }
  }
  return y;
}

/// How far to either side of the receiver, in a plane at this height, a beam that reaches it may start.
double reach_in_plane_m(const Viewer& viewer, double height_m) {
  return viewer.half_cone_rad < 0.49 * kPi ? height_m * std::tan(viewer.half_cone_rad) * (1 + 1e-9) : HUGE_VAL;
}

void cut_rectangle(double half_x_m, double half_y_m, const Viewer& viewer, std::vector<ShapePatch>& patches) {
  const Vec3& p = viewer.position_m;
  const double height_m = std::abs(p.z());
  if (!(height_m > 0) || !(half_x_m > 0) || !(half_y_m > 0)) return;
  const double towards = p.z() > 0 ? -1 : 1;
  const double reach_m = reach_in_plane_m(viewer, height_m);
  const PatchLimits x{std::max(-half_x_m - p.x(), -reach_m), std::min(half_x_m - p.x(), reach_m)};
  const PatchLimits y{std::max(-half_y_m - p.y(), -reach_m), std::min(half_y_m - p.y(), reach_m)};
  if (x.empty() || y.empty()) return;
  const std::vector<Point> seen = clipped({{x.low, y.low}, {x.high, y.low}, {x.high, y.high}, {x.low, y.high}},
                                          viewer.normal.x(), viewer.normal.y(), viewer.normal.z() * towards * height_m);
  std::vector<double> cuts;
  for (const Point& corner : seen) cuts.push_back(corner.x);
  std::sort(cuts.begin(), cuts.end());
  ShapePatch strip;
  strip.kind = ShapePatch::Kind::strip;
  strip.height_m = height_m;
  strip.towards = towards;
  strip.far = std::hypot(half_x_m, half_y_m) < kFar * p.norm();
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    strip.along = {cuts[i], cuts[i + 1]};
    if (!(strip.along.width() > 1e-14 * (x.high - x.low))) continue;
    // Slightly inside, so that an upright edge at a cut belongs to one side only.
    const double inset = 1e-9 * strip.along.width();
    const PatchLimits at_low = outline(seen, cuts[i] + inset), at_high = outline(seen, cuts[i + 1] - inset);
    strip.low_edge = {at_low.low, at_high.low};
    strip.high_edge = {at_low.high, at_high.high};
    patches.push_back(strip);
  }
}

void cut_disk(double radius_m, double plane_z_m, const Viewer& viewer, double half_cone_rad,
              std::vector<ShapePatch>& patches) {
  const Vec3 p = viewer.position_m - Vec3(0, 0, plane_z_m);
  const double height_m = std::abs(p.z());
  if (!(height_m > 0) || !(radius_m > 0)) return;
  ShapePatch disk;
  disk.kind = ShapePatch::Kind::disk;
  disk.height_m = height_m;
  disk.towards = p.z() > 0 ? -1 : 1;
  disk.radius_m = radius_m;
  disk.far = radius_m < kFar * p.norm();
  const double slope = std::hypot(viewer.normal.x(), viewer.normal.y());
  if (slope > 1e-12) disk.x_axis = Vec3(viewer.normal.x() / slope, viewer.normal.y() / slope, 0);
  disk.y_axis = Vec3(-disk.x_axis.y(), disk.x_axis.x(), 0);
  disk.middle_x_m = -p.dot(disk.x_axis);
  disk.middle_y_m = -p.dot(disk.y_axis);
  disk.reach_m = reach_in_plane_m({p, viewer.normal, half_cone_rad}, height_m);
  double min_x_m = -disk.reach_m;
  const double level = viewer.normal.z() * disk.towards * height_m;  // n · (x, y, ±h) = slope x + level
  if (slope > 1e-12)
    min_x_m = std::max(min_x_m, -level / slope);
  else if (!(level > 0))
    return;
  disk.along = {asin_within((min_x_m - disk.middle_x_m) / radius_m),
                asin_within((disk.reach_m - disk.middle_x_m) / radius_m)};
  if (!disk.along.empty()) patches.push_back(disk);
}

void cut_ball(double radius_m, const Viewer& viewer, std::vector<ShapePatch>& patches) {
  const double distance_m = viewer.position_m.norm();
  if (!(radius_m > 0) || !(distance_m > radius_m)) return;
  ShapePatch ball;
  ball.kind = ShapePatch::Kind::ball;
  ball.sin_half = radius_m / distance_m;
  ball.x_axis = -viewer.position_m / distance_m;
  const double facing = viewer.normal.dot(ball.x_axis);
  const Vec3 sideways = viewer.normal - facing * ball.x_axis;
  const double aside = sideways.norm();
  ball.y_axis = aside > 1e-12 ? Vec3(sideways / aside) : ball.x_axis.unitOrthogonal();
  ball.z_axis = ball.x_axis.cross(ball.y_axis);
  // n · direction ∝ facing cos a + aside sin a, which is above the horizon from a = -atan(facing / aside) on.
  const double min_rad = aside > 1e-12 ? -std::atan2(facing, aside) : (facing > 0 ? -kPi / 2 : kPi / 2);
  ball.along = {min_rad > -kPi / 2 ? asin_within(std::sin(min_rad) / ball.sin_half) : -kPi / 2, kPi / 2};
  if (min_rad < kPi / 2 && !ball.along.empty()) patches.push_back(ball);
}

void cut_cylinder(double radius_m, double half_length_m, const Viewer& viewer, std::vector<ShapePatch>& patches) {
  const Vec3& p = viewer.position_m;
  if (std::abs(p.z()) > half_length_m) cut_disk(radius_m, std::copysign(half_length_m, p.z()), viewer, kPi, patches);
  const double rho_m = std::hypot(p.x(), p.y());
  if (!(radius_m > 0) || !(half_length_m > 0) || !(rho_m > radius_m)) return;
  ShapePatch wall;
  wall.kind = ShapePatch::Kind::wall;
  wall.radius_m = radius_m;
  wall.rho_m = rho_m;
  wall.tangent_squared_m2 = (rho_m - radius_m) * (rho_m + radius_m);
  wall.x_axis = Vec3(-p.x() / rho_m, -p.y() / rho_m, 0);
  wall.y_axis = Vec3(-wall.x_axis.y(), wall.x_axis.x(), 0);
  wall.climb_m = {-half_length_m - p.z(), half_length_m - p.z()};
  wall.normal = viewer.normal;
  wall.along = {-kPi / 2, kPi / 2};
  wall.far = std::hypot(radius_m, half_length_m) < kFar * p.norm();
  patches.push_back(wall);
}

PatchPlace at_strip(const ShapePatch& strip, double t, double w) {
  const Along x = along_line(strip.along, strip.height_m, t, strip.far);
  const double share = (x.y - strip.along.low) / strip.along.width();
  const double d = std::hypot(x.y, strip.height_m);
  const Along y = along_line({strip.low_edge.at(share), strip.high_edge.at(share)}, d, w, strip.far);
  const Vec3 way(x.y, y.y, strip.towards * strip.height_m);
  // x.per_w has h²/d³ dx; wanted is dω = h dx dy / r³ = (h dx / d²) (d² dy / r³).
  return {way.normalized(), std::max(0.0, x.per_w * (d / strip.height_m) * y.per_w)};
}

PatchPlace at_disk(const ShapePatch& disk, double t, double w) {
  const double angle = disk.along.at(t);
  const double chord_m = disk.radius_m * std::cos(angle);
  const double x = disk.middle_x_m + disk.radius_m * std::sin(angle);
  const double d2 = x * x + squared(disk.height_m), d = std::sqrt(d2);
  const PatchLimits limits{std::max(disk.middle_y_m - chord_m, -disk.reach_m),
                           std::min(disk.middle_y_m + chord_m, disk.reach_m)};
  if (limits.empty()) return {disk.x_axis, 0};
  const Along y = along_line(limits, d, w, disk.far);
  const Vec3 way = x * disk.x_axis + y.y * disk.y_axis + Vec3(0, 0, disk.towards * disk.height_m);
  return {way.normalized(), disk.along.width() * chord_m * disk.height_m / d2 * y.per_w};
}

PatchPlace at_ball(const ShapePatch& ball, double t, double w) {
  const double angle = ball.along.at(t);
  const double sin_a = ball.sin_half * std::sin(angle), cos_a = std::sqrt(std::max(0.0, 1 - sin_a * sin_a));
  const double rim = ball.sin_half * std::cos(angle) / cos_a;  // = da/dt, too
  const double s = (2 * w - 1) * rim, c = std::sqrt(std::max(0.0, 1 - s * s));
  return {c * (cos_a * ball.x_axis + sin_a * ball.y_axis) + s * ball.z_axis,
          std::max(0.0, ball.along.width() * rim * 2 * rim)};
}

PatchPlace at_wall(const ShapePatch& wall, double t, double w) {
  const double angle = wall.along.at(t);
  const double sin_eta = wall.radius_m / wall.rho_m * std::sin(angle);
  const double cos_eta = std::sqrt(std::max(0.0, 1 - sin_eta * sin_eta));
  const double d = wall.tangent_squared_m2 / (wall.rho_m * cos_eta + wall.radius_m * std::cos(angle));
  const Vec3 level = cos_eta * wall.x_axis + sin_eta * wall.y_axis;
  PatchLimits climb_m = wall.climb_m;
  const double facing = wall.normal.dot(level), upwards = wall.normal.z();
  if (upwards > 1e-12)
    climb_m.low = std::max(climb_m.low, -facing * d / upwards);
  else if (upwards < -1e-12)
    climb_m.high = std::min(climb_m.high, -facing * d / upwards);
  else if (!(facing > 0))
    return {level, 0};
  if (climb_m.empty() || !(cos_eta > 0)) return {level, 0};
  const Along z = along_line(climb_m, d, w, wall.far);
  const double eta_per_t = wall.along.width() * wall.radius_m / wall.rho_m * std::cos(angle) / cos_eta;
  return {(d * level + Vec3(0, 0, z.y)).normalized(), std::max(0.0, eta_per_t * z.per_w)};
}

}  // namespace

PatchPlace ShapePatch::at(double t, double w) const {
  switch (kind) {
    case Kind::strip:
      return at_strip(*this, t, w);
    case Kind::disk:
      return at_disk(*this, t, w);
    case Kind::ball:
      return at_ball(*this, t, w);
    case Kind::wall:
      return at_wall(*this, t, w);
  }
  return {};
}

void cut_into_patches(const LuminousShape& shape, const Viewer& viewer, std::vector<ShapePatch>& patches) {
  patches.clear();
  const Vec3 half_m = 0.5 * shape.size_m;
  switch (shape.kind) {
    case LuminousShape::Kind::point:
      return;
    case LuminousShape::Kind::rectangle:
      return cut_rectangle(half_m.x(), half_m.y(), viewer, patches);
    case LuminousShape::Kind::disk:
      return cut_disk(half_m.x(), 0, viewer, viewer.half_cone_rad, patches);
    case LuminousShape::Kind::sphere:
      return cut_ball(half_m.x(), viewer, patches);
    case LuminousShape::Kind::cylinder:
      return cut_cylinder(half_m.x(), half_m.z(), viewer, patches);
  }
}

}  // namespace luxrig
