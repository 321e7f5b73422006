/// The rectangle as seen from a point: uniform over its solid angle.
///
/// C. Ureña, M. Fajardo and A. King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013; inverted
/// here in another form, which keeps its digits near the rectangle's plane. With the observer at the origin and the
/// rectangle [x0, x1] × [y0, y1] at height h, the part of the solid angle below x is
///   Ω(x) = g(x) - g(x0),   g(x) = asin(s b1) - asin(s b0),   s = x/√(x²+h²),   bi = yi/√(yi²+h²).
/// sin g(x) and the two bi have the ratio of the sides of a triangle, whose law of cosines gives s from g:
///   s = sin g / √(b0² + b1² - 2 b0 b1 cos g).

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_kinds.h"

namespace luxrig {
namespace {

/// Below this solid angle [sr], Ω is a difference of angles that has lost half its digits. Points are then sampled
/// uniformly over the area, which is as good for a rectangle so far away.
constexpr double kSmall = 1e-7;
/// A direction aimed at the rim may miss it through rounding.
constexpr double kRectangleRim = 1 + 1e-12;

/// y/√(y²+d²) and its distance from ±1, both to full precision.
struct Sine {
  Sine(double y, double d) : sign(y < 0 ? -1 : 1) {
    const double hypotenuse = std::hypot(y, d);
    value = y / hypotenuse;
    from_one = (d / hypotenuse) * (d / (hypotenuse + std::abs(y)));
  }
  double sign, value, from_one;
  [[nodiscard]] double minus(const Sine& other) const {
    return sign == other.sign ? sign * (other.from_one - from_one) : value - other.value;
  }
};

struct SeenRectangle {
  SeenRectangle(const Rectangle& rectangle, const Vec3& from_m)
      : x0(-rectangle.half_x_m - from_m.x()),
        x1(rectangle.half_x_m - from_m.x()),
        y0(-rectangle.half_y_m - from_m.y()),
        y1(rectangle.half_y_m - from_m.y()),
        height(std::abs(from_m.z())),
        towards(from_m.z() > 0 ? -1 : 1),
        area(4 * rectangle.half_x_m * rectangle.half_y_m) {
    if (!(area > 0) || !(height > 0)) return;
    at_x0 = g(x0);
    solid_angle = g(x1) - at_x0;
    by_area = !(solid_angle > kSmall);
  }

  [[nodiscard]] double g(double x) const {
    const auto angle = [&](double y) { return std::atan2(x * y, height * std::hypot(x, y, height)); };
    return angle(y1) - angle(y0);
  }

  [[nodiscard]] bool visible() const { return area > 0 && height > 0; }

  /// Density of sampling by area, at a distance along a direction whose cosine to the plane's normal is `cosine`.
  [[nodiscard]] double area_density(double distance_m, double cosine) const {
    return distance_m * (distance_m / area) / cosine;
  }

  double x0, x1, y0, y1, height, towards, area;
  double at_x0 = 0, solid_angle = 0;
  bool by_area = true;
};

double place_at(const SeenRectangle& seen, double part) {
  const double g = seen.at_x0 + part * seen.solid_angle;
  const Sine b0(seen.y0, seen.height), b1(seen.y1, seen.height);
  const double half = std::sin(0.5 * g), cos_half = std::cos(0.5 * g);
  const double difference = b1.minus(b0), sum = b0.value + b1.value, product = b0.value * b1.value;
  const double squared =
      product > 0 ? difference * difference + 4 * product * half * half : sum * sum - 4 * product * cos_half * cos_half;
  const double s = 2 * half * cos_half / std::sqrt(squared);
  const double x = seen.height * s / std::sqrt(std::max(0.0, (1 - s) * (1 + s)));
  return std::isnan(x) ? seen.x0 + part * (seen.x1 - seen.x0) : std::clamp(x, seen.x0, seen.x1);
}

/// Uniform in y/√(y²+d²), with d the distance from the line x = const.
double along_line(const SeenRectangle& seen, double x, double part) {
  const double d = std::hypot(x, seen.height);
  const Sine h0(seen.y0, d), h1(seen.y1, d);
  double y;
  if (h0.sign == h1.sign) {
    const double from_one = h0.from_one + part * (h1.from_one - h0.from_one);
    y = h0.sign * (1 - from_one) * d / std::sqrt(from_one * (2 - from_one));
  } else {
    const double h = h0.value + part * (h1.value - h0.value);
    y = h * d / std::sqrt((1 - h) * (1 + h));
  }
  return std::isnan(y) ? seen.y0 + part * (seen.y1 - seen.y0) : std::clamp(y, seen.y0, seen.y1);
}

}  // namespace

ShapeSample sample_seen_from(const Rectangle& rectangle, const Vec3& from_m, double u, double v) {
  const SeenRectangle seen(rectangle, from_m);
  if (!seen.visible()) return {};
  Vec3 way_m(0, 0, seen.towards * seen.height);
  if (seen.by_area) {
    way_m.x() = seen.x0 + u * (seen.x1 - seen.x0);
    way_m.y() = seen.y0 + v * (seen.y1 - seen.y0);
  } else {
    way_m.x() = place_at(seen, u);
    way_m.y() = along_line(seen, way_m.x(), v);
  }
  const double distance_m = way_m.norm();
  const double density = seen.by_area ? seen.area_density(distance_m, seen.height / distance_m) : 1 / seen.solid_angle;
  return {way_m / distance_m, distance_m, density};
}

double density_seen_from(const Rectangle& rectangle, const Vec3& from_m, const Vec3& direction) {
  const SeenRectangle seen(rectangle, from_m);
  const double cosine = seen.towards * direction.z();
  if (!seen.visible() || !(cosine > 0)) return 0;
  const double distance_m = seen.height / cosine;
  const double rim_m = 1e-15 * (from_m.norm() + distance_m);
  if (!(std::abs(from_m.x() + distance_m * direction.x()) <= kRectangleRim * rectangle.half_x_m + rim_m)) return 0;
  if (!(std::abs(from_m.y() + distance_m * direction.y()) <= kRectangleRim * rectangle.half_y_m + rim_m)) return 0;
  return seen.by_area ? seen.area_density(distance_m, cosine) : 1 / seen.solid_angle;
}

}  // namespace luxrig
