#pragma once
/// Internal to core/photometry: solid-angle sampling of each kind of luminous shape, as described in shape_sampling.h.
/// All in frame lamp. Points and sizes are finite.

#include <array>

#include "core/photometry/shapes/shape_sampling.h"

namespace luxrig {

/// Sizes as used in the formulas.
struct Rectangle {
  double half_x_m, half_y_m;
};
struct Disk {
  double radius_m;
};
struct Ball {
  double radius_m;
};
struct Cylinder {
  double radius_m, half_length_m;
};

[[nodiscard]] ShapeSample sample_seen_from(const Rectangle& rectangle, const Vec3& from_m, double u, double v);
[[nodiscard]] double density_seen_from(const Rectangle& rectangle, const Vec3& from_m, const Vec3& direction);

[[nodiscard]] ShapeSample sample_seen_from(const Disk& disk, const Vec3& from_m, double u, double v);
[[nodiscard]] double density_seen_from(const Disk& disk, const Vec3& from_m, const Vec3& direction);

[[nodiscard]] ShapeSample sample_seen_from(const Ball& ball, const Vec3& from_m, double u, double v);
[[nodiscard]] double density_seen_from(const Ball& ball, const Vec3& from_m, const Vec3& direction);

[[nodiscard]] ShapeSample sample_seen_from(const Cylinder& cylinder, const Vec3& from_m, double u, double v);
[[nodiscard]] double density_seen_from(const Cylinder& cylinder, const Vec3& from_m, const Vec3& direction);

/// Maps the unit square to the unit disk, preserving area ratios (P. Shirley and K. Chiu, 1997).
struct OnUnitDisk {
  double cos_angle, sin_angle;
  double radius_squared;  ///< uniform over 0…1
};
[[nodiscard]] OnUnitDisk concentric(double u, double v);

/// A disk seen from a point off its plane: a cone with an elliptical cross-section.
///
/// Take the diameter that points at the observer. The rays to its two ends lie in the cone's plane of symmetry, so
/// their bisector is the cone's axis. Let l0, l1 be the lengths of those rays. Half the wider opening (across that
/// plane) is α with sin α = 2r/(l0+l1). Half the narrower one is β, by the law of cosines.
class DiskCone {
 public:
  /// requires r > 0 and height (|z|) > 0
  DiskCone(const Disk& disk, const Vec3& from_m);

  [[nodiscard]] DirectionSample sample(double u, double v) const;
  [[nodiscard]] double density_per_sr(const Vec3& direction) const;
  /// Its solid angle to within a tenth.
  [[nodiscard]] double rough_solid_angle_sr() const { return kPi * wide_ * narrow_; }

 private:
  /// 1 - cos of the cone's half opening at azimuth φ about its axis.
  [[nodiscard]] double rim(double cos_azimuth, double sin_azimuth) const;
  [[nodiscard]] double density_at(double cos_azimuth, double sin_azimuth) const;

  Vec3 axis_, across_, along_;  ///< unit; `across_` perpendicular to the plane of symmetry, `along_` in it
  double tan2_wide_, tan2_narrow_;
  double wide_, narrow_;  ///< 2 sin(α/2), 2 sin(β/2)
};

}  // namespace luxrig
