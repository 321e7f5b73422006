#pragma once
/// Luminance of the sky, including the sun, by direction: daylight as an emitter at infinity.

#include <memory>

#include "core/photometry/intensity.h"

namespace luxrig {

class SkyLuminance {
 public:
  virtual ~SkyLuminance() = default;

  /// Luminance [cd/m²] in a direction; 0 below the horizon.
  /// direction_world   unit, towards the sky
  [[nodiscard]] virtual double luminance_cd_m2(const Vec3& direction_world) const = 0;

  /// Illuminance [lx] on an unobstructed horizontal plane facing up.
  [[nodiscard]] virtual double horizontal_illuminance_lx() const = 0;

  /// Direction towards the sky for a point of the unit square, sampled with density_per_sr().
  [[nodiscard]] virtual DirectionSample sample(double u, double v) const = 0;
  [[nodiscard]] virtual double density_per_sr(const Vec3& direction_world) const = 0;
};

using Sky = std::shared_ptr<const SkyLuminance>;

}  // namespace luxrig
