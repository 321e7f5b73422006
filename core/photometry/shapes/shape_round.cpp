/// Disk and sphere as seen from a point.

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_kinds.h"

namespace luxrig {
namespace {

/// A direction aimed at the rim may miss it through rounding.
constexpr double kRoundRim = 1 + 1e-12;

/// 1 - cos θ from tan² θ, θ ≤ π/2, to full precision.
double versine_from_tan2(double tan2) {
  if (!std::isfinite(tan2)) return 1;
  const double secant = std::sqrt(1 + tan2);
  return tan2 / (secant * (1 + secant));
}

/// Any two unit vectors perpendicular to a unit vector (T. Duff et al., JCGT 6(1), 2017).
std::array<Vec3, 2> basis_about(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  return {Vec3(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()), Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

}  // namespace

OnUnitDisk concentric(double u, double v) {
  const double a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {1, 0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b;
  const double angle = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
  const double sign = radius < 0 ? -1 : 1;
  return {sign * std::cos(angle), sign * std::sin(angle), radius * radius};
}

DiskCone::DiskCone(const Disk& disk, const Vec3& from_m) {
  const double r = disk.radius_m, h = std::abs(from_m.z()), rho = std::hypot(from_m.x(), from_m.y());
  // In units of the largest length, so that squares neither overflow nor underflow.
  const double unit = std::max({r, h, rho});
  const double r1 = r / unit, h1 = h / unit, rho1 = rho / unit;
  // l0 l1 = √(m² + 4r²h²), (l0 ± l1)² ∓ 4r² = 2 (l0 l1 ± m): written without differences of similar numbers.
  const double m = (rho1 - r1) * (rho1 + r1) + h1 * h1;
  const double cross = 2 * r1 * h1;
  const double product = std::hypot(m, cross);
  const double plus = m >= 0 ? product + m : cross * (cross / (product - m));
  const double minus = m <= 0 ? product - m : cross * (cross / (product + m));
  tan2_wide_ = 2 * r1 * r1 / plus;
  tan2_narrow_ = minus / plus;
  wide_ = std::sqrt(2 * versine_from_tan2(tan2_wide_));
  narrow_ = std::sqrt(2 * versine_from_tan2(tan2_narrow_));

  const double sum_squared = 2 * plus + 4 * r1 * r1;  // (l0 + l1)²
  const double towards = from_m.z() > 0 ? -1 : 1;
  const Vec3 outwards = rho > 0 ? Vec3(from_m.x() / rho, from_m.y() / rho, 0) : Vec3(Vec3::UnitX());
  const double inwards_m = 2 * rho1 * plus / sum_squared, length_m = std::hypot(inwards_m, h1);
  axis_ = -(inwards_m / length_m) * outwards + Vec3(0, 0, towards * h1 / length_m);
  along_ = (h1 / length_m) * outwards + Vec3(0, 0, towards * inwards_m / length_m);
  across_ = Vec3(-outwards.y(), outwards.x(), 0);
}

double DiskCone::rim(double cos_azimuth, double sin_azimuth) const {
  const double c2 = cos_azimuth * cos_azimuth, s2 = sin_azimuth * sin_azimuth;
  return versine_from_tan2(tan2_narrow_ / (c2 * (tan2_narrow_ / tan2_wide_) + s2));
}

double DiskCone::density_at(double cos_azimuth, double sin_azimuth) const {
  const double c = narrow_ * cos_azimuth, s = wide_ * sin_azimuth;
  return wide_ * narrow_ / (2 * kPi * (c * c + s * s)) / rim(cos_azimuth, sin_azimuth);
}

// Azimuths as in an ellipse with the axes of the cone in Lambert's equal-area projection, radii uniform in solid angle.
// In that projection the cone is nearly that ellipse. The density corrects the difference exactly.
DirectionSample DiskCone::sample(double u, double v) const {
  const OnUnitDisk at = concentric(u, v);
  const double c = wide_ * at.cos_angle, s = narrow_ * at.sin_angle, length = std::hypot(c, s);
  const double cos_azimuth = c / length, sin_azimuth = s / length;
  const double versine = at.radius_squared * rim(cos_azimuth, sin_azimuth);
  const double sine = std::sqrt(versine * (2 - versine));
  return {(1 - versine) * axis_ + sine * (cos_azimuth * across_ + sin_azimuth * along_),
          density_at(cos_azimuth, sin_azimuth)};
}

double DiskCone::density_per_sr(const Vec3& direction) const {
  const double forward = direction.dot(axis_);
  if (!(forward > 0)) return 0;
  const double c = direction.dot(across_), s = direction.dot(along_);
  const double sine = std::hypot(c, s);
  if (sine == 0) return density_at(1, 0);
  if (!(sine * sine / (1 + forward) <= kRoundRim * rim(c / sine, s / sine))) return 0;
  return density_at(c / sine, s / sine);
}

ShapeSample sample_seen_from(const Disk& disk, const Vec3& from_m, double u, double v) {
  const double height_m = std::abs(from_m.z());
  if (!(disk.radius_m > 0) || !(height_m > 0)) return {};
  const DirectionSample drawn = DiskCone(disk, from_m).sample(u, v);
  const double farthest_m = std::hypot(std::hypot(from_m.x(), from_m.y()) + disk.radius_m, height_m);
  return {drawn.direction, std::min(height_m / std::abs(drawn.direction.z()), farthest_m), drawn.density_per_sr};
}

double density_seen_from(const Disk& disk, const Vec3& from_m, const Vec3& direction) {
  if (!(disk.radius_m > 0) || !(std::abs(from_m.z()) > 0)) return 0;
  return DiskCone(disk, from_m).density_per_sr(direction);
}

namespace {

/// The cone filled by a sphere.
struct BallCone {
  BallCone(const Ball& ball, const Vec3& from_m) : distance_m(from_m.norm()), radius_m(ball.radius_m) {
    if (!(radius_m > 0) || !(distance_m > radius_m)) return;
    tangent_squared_m2 = (distance_m - radius_m) * (distance_m + radius_m);
    const double sine = radius_m / distance_m, cosine = std::sqrt(tangent_squared_m2) / distance_m;
    versine = sine * (sine / (1 + cosine));
    density_per_sr = 1 / (2 * kPi * versine);
  }
  double distance_m, radius_m, tangent_squared_m2 = 0, versine = 0, density_per_sr = 0;
};

}  // namespace

ShapeSample sample_seen_from(const Ball& ball, const Vec3& from_m, double u, double v) {
  const BallCone cone(ball, from_m);
  if (!(cone.density_per_sr > 0)) return {};
  const Vec3 axis = from_m / -cone.distance_m;
  const auto [x, y] = basis_about(axis);
  const OnUnitDisk at = concentric(u, v);
  const double versine = at.radius_squared * cone.versine;
  const double sine = std::sqrt(versine * (2 - versine)), across_m = cone.distance_m * sine;
  // The product of the distances to both intersections is the tangent's square; this gives the nearer one.
  const double half_chord_m = std::sqrt(std::max(0.0, (cone.radius_m - across_m) * (cone.radius_m + across_m)));
  const double distance_m = cone.tangent_squared_m2 / (cone.distance_m * (1 - versine) + half_chord_m);
  return {(1 - versine) * axis + sine * (at.cos_angle * x + at.sin_angle * y), distance_m, cone.density_per_sr};
}

double density_seen_from(const Ball& ball, const Vec3& from_m, const Vec3& direction) {
  const BallCone cone(ball, from_m);
  if (!(cone.density_per_sr > 0) || !(direction.dot(from_m) < 0)) return 0;
  const double sine = direction.cross(from_m).norm() / cone.distance_m;
  return sine <= kRoundRim * (cone.radius_m / cone.distance_m) ? cone.density_per_sr : 0;
}

}  // namespace luxrig
