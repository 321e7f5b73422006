/// The cylinder as seen from a point: its wall, and the one end that faces the point.
///
/// The wall is sampled by azimuth η about the observer's own vertical, uniformly between the two tangents, and then
/// uniformly in the sine of the elevation over the wall's height at that azimuth. dω = dη d(sin elevation), so the
/// density is exact. An end is a disk. Wall and end are chosen roughly in proportion to their solid angles. Since the
/// cylinder is convex, each direction meets exactly one of them from outside.

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_kinds.h"

namespace luxrig {
namespace {

constexpr double kRim = 1 + 1e-12;

class Seen {
 public:
  Seen(const Cylinder& cylinder, const Vec3& from_m)
      : radius_m_(cylinder.radius_m),
        end_z_m_(std::copysign(cylinder.half_length_m, from_m.z())),
        rho_m_(std::hypot(from_m.x(), from_m.y())),
        low_m_(-cylinder.half_length_m - from_m.z()),
        high_m_(cylinder.half_length_m - from_m.z()),
        from_end_m_(from_m - Vec3(0, 0, end_z_m_)),
        sees_wall_(rho_m_ > radius_m_ && radius_m_ > 0 && cylinder.half_length_m > 0),
        sees_end_(radius_m_ > 0 && std::abs(from_m.z()) > cylinder.half_length_m) {
    double wall_sr = 0, end_sr = 0;
    if (sees_wall_) {
      inwards_ = Vec3(-from_m.x() / rho_m_, -from_m.y() / rho_m_, 0);
      tangent_squared_m2_ = (rho_m_ - radius_m_) * (rho_m_ + radius_m_);
      half_azimuth_rad_ = std::atan2(radius_m_, std::sqrt(tangent_squared_m2_));
      const auto rise = [this](double azimuth_rad) { return height(wall_distance_m(std::sin(azimuth_rad))); };
      // Simpson's rule over the half-width. The tangent, where the distance changes fastest, has the least weight.
      wall_sr = 2 * half_azimuth_rad_ / 6 * (rise(0) + 4 * rise(0.5 * half_azimuth_rad_) + rise(half_azimuth_rad_));
    }
    if (sees_end_) end_sr = DiskCone({radius_m_}, from_end_m_).rough_solid_angle_sr();
    if (!(wall_sr > 0)) sees_wall_ = false;
    if (!(end_sr > 0)) sees_end_ = false;
    wall_share_ = sees_wall_ ? (sees_end_ ? wall_sr / (wall_sr + end_sr) : 1) : 0;
  }

  [[nodiscard]] ShapeSample sample(double u, double v) const {
    if (!sees_wall_ && !sees_end_) return {};
    if (u >= wall_share_) {
      if (!sees_end_) return sample_wall(1, v);
      ShapeSample sample = sample_seen_from(Disk{radius_m_}, from_end_m_, (u - wall_share_) / (1 - wall_share_), v);
      sample.density_per_sr *= 1 - wall_share_;
      return sample;
    }
    return sample_wall(u / wall_share_, v);
  }

  [[nodiscard]] double density_per_sr(const Vec3& direction) const {
    const double across = std::hypot(direction.x(), direction.y());
    if (sees_wall_ && across > 0) {
      const double forward = direction.dot(inwards_) / across;
      const double sine = (direction.x() * inwards_.y() - direction.y() * inwards_.x()) / across;
      if (forward > 0 && std::abs(sine) <= kRim * (radius_m_ / rho_m_)) {
        const double distance_m = wall_distance_m(sine);
        const double climb_m = distance_m * direction.z() / across;
        const double rim_m = 1e-12 * (high_m_ - low_m_) + 1e-15 * (std::abs(climb_m) + std::abs(high_m_));
        if (climb_m >= low_m_ - rim_m && climb_m <= high_m_ + rim_m)
          return wall_share_ / (2 * half_azimuth_rad_ * height(distance_m));
      }
    }
    return sees_end_ ? (1 - wall_share_) * density_seen_from(Disk{radius_m_}, from_end_m_, direction) : 0;
  }

 private:
  /// Horizontal distance to the wall at an azimuth from the cylinder's axis.
  [[nodiscard]] double wall_distance_m(double sin_azimuth) const {
    const double across_m = rho_m_ * sin_azimuth;
    const double forward_m = rho_m_ * std::sqrt(std::max(0.0, (1 - sin_azimuth) * (1 + sin_azimuth)));
    const double half_chord_m = std::sqrt(std::max(0.0, (radius_m_ - across_m) * (radius_m_ + across_m)));
    return tangent_squared_m2_ / (forward_m + half_chord_m);
  }

  /// Difference of the sines of elevation of the wall's upper and lower edge, seen from a horizontal distance.
  [[nodiscard]] double height(double distance_m) const {
    const double low = std::hypot(low_m_, distance_m), high = std::hypot(high_m_, distance_m);
    if (low_m_ < 0 && high_m_ > 0) return high_m_ / high - low_m_ / low;
    // Same sign: (b²-a²) d² / (lo hi (b lo + a hi)), which avoids their difference.
    const double a = std::abs(low_m_), b = std::abs(high_m_);
    return std::abs(distance_m / low * (distance_m / high) * ((b - a) * (b + a)) / (b * low + a * high));
  }

  [[nodiscard]] ShapeSample sample_wall(double u, double v) const {
    const double azimuth_rad = (2 * u - 1) * half_azimuth_rad_;
    const double sin_azimuth = std::sin(azimuth_rad), cos_azimuth = std::cos(azimuth_rad);
    const double distance_m = wall_distance_m(sin_azimuth);
    const double climb_m = climb(distance_m, v);
    const Vec3 sideways(inwards_.y(), -inwards_.x(), 0);
    const Vec3 way_m = distance_m * (cos_azimuth * inwards_ + sin_azimuth * sideways) + Vec3(0, 0, climb_m);
    const double length_m = way_m.norm();
    return {way_m / length_m, length_m, wall_share_ / (2 * half_azimuth_rad_ * height(distance_m))};
  }

  /// Height above the observer at which the sine of the elevation is at share `part` between those of the edges.
  [[nodiscard]] double climb(double distance_m, double part) const {
    const double low = std::hypot(low_m_, distance_m), high = std::hypot(high_m_, distance_m);
    double climb_m;
    if (low_m_ < 0 && high_m_ > 0) {
      const double sine = (1 - part) * (low_m_ / low) + part * (high_m_ / high);
      climb_m = distance_m * sine / std::sqrt((1 - sine) * (1 + sine));
    } else {
      // From the distance of the sines to ±1, which keeps its digits far above and far below.
      const double sign = low_m_ < 0 ? -1 : 1;
      const double at_low = distance_m / low * (distance_m / (low + std::abs(low_m_)));
      const double at_high = distance_m / high * (distance_m / (high + std::abs(high_m_)));
      const double from_one = at_low + part * (at_high - at_low);
      climb_m = sign * (1 - from_one) * distance_m / std::sqrt(from_one * (2 - from_one));
    }
    return std::isnan(climb_m) ? low_m_ + part * (high_m_ - low_m_) : std::clamp(climb_m, low_m_, high_m_);
  }

  double radius_m_, end_z_m_, rho_m_;
  double low_m_, high_m_;  ///< the wall's lower and upper edge, relative to the observer's height
  Vec3 from_end_m_;        ///< the observer, relative to the middle of the facing end
  bool sees_wall_, sees_end_;
  Vec3 inwards_ = Vec3::UnitX();
  double tangent_squared_m2_ = 0, half_azimuth_rad_ = 0;
  double wall_share_ = 0;
};

}  // namespace

ShapeSample sample_seen_from(const Cylinder& cylinder, const Vec3& from_m, double u, double v) {
  return Seen(cylinder, from_m).sample(u, v);
}

double density_seen_from(const Cylinder& cylinder, const Vec3& from_m, const Vec3& direction) {
  return Seen(cylinder, from_m).density_per_sr(direction);
}

}  // namespace luxrig
