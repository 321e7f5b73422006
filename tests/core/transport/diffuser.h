#pragma once
/// Flat diffuser: a luminaire whose light has a closed form at any place.

#include <cmath>
#include <memory>

#include "core/photometry/intensity.h"
#include "core/photometry/shapes/luminous_shape.h"

namespace luxrig {

/// I0 cos γ about -Z, on both sides or below only.
class Diffuser final : public IntensityDistribution {
 public:
  explicit Diffuser(double peak_cd, bool both_sides = false) : peak_cd_(peak_cd), both_sides_(both_sides) {}
  double intensity_cd(const Vec3& d) const override {
    return peak_cd_ * (both_sides_ ? std::abs(d.z()) : std::max(0.0, -d.z()));
  }
  double flux_lm() const override { return (both_sides_ ? 2 : 1) * kPi * peak_cd_; }
  double max_intensity_cd() const override { return peak_cd_; }
  double emission_cone_rad() const override { return both_sides_ ? 2 * kPi : kPi; }

 private:
  double peak_cd_;
  bool both_sides_;
};

inline Intensity diffuser(double peak_cd) { return std::make_shared<Diffuser>(peak_cd); }
inline LuminousShape rectangle(double x_m, double y_m) { return {LuminousShape::Kind::rectangle, {x_m, y_m, 0}}; }

}  // namespace luxrig
