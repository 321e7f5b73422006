#include "core/solve/placement/scene/surface_lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace luxrig {
namespace {

using Vec2 = Eigen::Vector2d;

Vec3 doubled_area(const std::array<Vec3, 3>& triangle_m) {
  return (triangle_m[1] - triangle_m[0]).cross(triangle_m[2] - triangle_m[0]);
}

/// Twice the signed area of (a, b, p); swapping a and b changes only its sign.
double side_of(const Vec2& a, const Vec2& b, const Vec2& p) {
  const bool swapped = b.x() < a.x() || (b.x() == a.x() && b.y() < a.y());
  const Vec2 &first = swapped ? b : a, &second = swapped ? a : b;
  const Vec2 along = second - first, to = p - first;
  const double side = along.x() * to.y() - along.y() * to.x();
  return swapped ? -side : side;
}

/// A point on an edge belongs to the triangle left of it if the edge runs down, or horizontally to the right.
bool owns_its_points(const Vec2& a, const Vec2& b) { return b.y() < a.y() || (b.y() == a.y() && b.x() > a.x()); }

bool covers(const std::array<Vec2, 3>& corners, const Vec2& p) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % 3];
    const double side = side_of(a, b, p);
    if (side < 0 || (side == 0 && !owns_its_points(a, b))) return false;
  }
  return true;
}

/// Range of x in the triangle at this y, to rounding: rows of a long slanting triangle need no full search.
std::pair<double, double> span_at(const std::array<Vec2, 3>& corners, double y) {
  std::pair<double, double> span{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % 3];
    if (std::min(a.y(), b.y()) > y || std::max(a.y(), b.y()) < y) continue;
    const double share = a.y() == b.y() ? 0 : (y - a.y()) / (b.y() - a.y());
    for (const double x : {a.x() + share * (b.x() - a.x()), a.y() == b.y() ? b.x() : a.x() + share * (b.x() - a.x())}) {
      span.first = std::min(span.first, x);
      span.second = std::max(span.second, x);
    }
  }
  return span;
}

}  // namespace

double widest_shadow_m2(const std::array<Vec3, 3>& triangle_m) {
  return doubled_area(triangle_m).cwiseAbs().maxCoeff() / 2;
}

std::vector<Vec3> lattice_on(const std::array<Vec3, 3>& triangle_m, double spacing_m) {
  std::vector<Vec3> points_m;
  const Vec3 normal = doubled_area(triangle_m);
  Eigen::Index up = 0;
  if (!(normal.cwiseAbs().maxCoeff(&up) > 0)) return points_m;
  const Eigen::Index right = (up + 1) % 3, ahead = (up + 2) % 3;
  std::array<Vec2, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = {triangle_m[i][right], triangle_m[i][ahead]};
  if (normal[up] < 0) std::swap(corners[1], corners[2]);  // counter-clockwise
  const double low_m = std::min({corners[0].y(), corners[1].y(), corners[2].y()});
  const double high_m = std::max({corners[0].y(), corners[1].y(), corners[2].y()});
  const auto first = [&](double from_m) { return std::ceil(from_m / spacing_m - 0.5); };
  for (double j = first(low_m); (j + 0.5) * spacing_m <= high_m; ++j) {
    const auto [from_m, to_m] = span_at(corners, (j + 0.5) * spacing_m);
    for (double i = first(from_m) - 1; (i - 0.5) * spacing_m <= to_m; ++i) {
      const Vec2 p((i + 0.5) * spacing_m, (j + 0.5) * spacing_m);
      if (!covers(corners, p)) continue;
      Vec3 point_m;
      point_m[right] = p.x();
      point_m[ahead] = p.y();
      point_m[up] = triangle_m[0][up] -
                    (normal[right] * (p.x() - triangle_m[0][right]) + normal[ahead] * (p.y() - triangle_m[0][ahead])) /
                        normal[up];
      points_m.push_back(point_m);
    }
  }
  return points_m;
}

}  // namespace luxrig
