#pragma once
/// Configuration factors times π: illuminance from surfaces of luminance 1.

#include <cmath>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Polygon: contour integral over its outline cut at the horizon (J. H. Lambert 1760; in vector form P. Moon 1936).
inline double polygon_form(const std::vector<Vec3>& corners_m, const Vec3& p, const Vec3& n) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < corners_m.size(); ++k) {
    const Vec3 a = corners_m[k] - p, b = corners_m[(k + 1) % corners_m.size()] - p;
    if (n.dot(a) >= 0) kept.push_back(a);
    if ((n.dot(a) >= 0) != (n.dot(b) >= 0)) kept.push_back(a + n.dot(a) / (n.dot(a) - n.dot(b)) * (b - a));
  }
  double sum = 0;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const Vec3 &a = kept[k], &b = kept[(k + 1) % kept.size()];
    const Vec3 cross = a.cross(b);
    if (cross.norm() > 0) sum += std::atan2(cross.norm(), a.dot(b)) * n.dot(cross) / cross.norm();
  }
  return std::abs(sum) / 2;
}

/// Rectangle in the plane z = z_m.
inline double rectangle_form(double x0_m, double x1_m, double y0_m, double y1_m, double z_m, const Vec3& p,
                             const Vec3& n) {
  return polygon_form({{x0_m, y0_m, z_m}, {x1_m, y0_m, z_m}, {x1_m, y1_m, z_m}, {x0_m, y1_m, z_m}}, p, n);
}

/// Disk of radius r, parallel to the receiver: distance h to the disk's plane, distance a to its axis.
inline double parallel_disk_form(double r, double h, double a) {
  const double s = h * h + a * a + r * r;
  return kPi / 2 * (1 - (h * h + a * a - r * r) / std::sqrt(s * s - 4 * a * a * r * r));
}

/// Sphere fully above the horizon: π (R/d)² cos β. Partly: J. R. Howell's catalogue, configuration factor B-43.
inline double sphere_form(double radius, double distance, double cos_beta) {
  const double h = distance / radius, beta = std::acos(cos_beta);
  if (cos_beta * h >= 1) return kPi * cos_beta / (h * h);
  if (cos_beta * h <= -1) return 0;
  const double x = std::sqrt(h * h - 1), y = -x / std::tan(beta);
  return (cos_beta * std::acos(y) - x * std::sin(beta) * std::sqrt(1 - y * y)) / (h * h) +
         std::atan(std::sin(beta) * std::sqrt(1 - y * y) / x);
}

}  // namespace luxrig
