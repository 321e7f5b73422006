#pragma once
// Properties of every accepted photometric file.

#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/result.h"

namespace luxrig::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void require_said(const std::vector<Problem>& problems) {
  require(!problems.empty());
  for (const Problem& problem : problems) {
    require(!problem.what.empty() && !problem.mend.empty() && problem.line >= 0 && problem.column >= 0);
  }
}

/// Every value is finite, not negative and below the maximum; the flux is positive; it is dark outside the cone;
/// sampled directions are unit vectors with the distribution's own density.
inline void require_sound(const IntensityDistribution& light) {
  require(std::isfinite(light.flux_lm()) && light.flux_lm() > 0);
  const double max_cd = light.max_intensity_cd() * (1 + 1e-9);
  for (int i = 0; i <= 24; ++i) {
    for (int j = -12; j <= 12; ++j) {
      const double gamma = i * kPi / 24;
      const double c = j * kPi / 12;
      const Vec3 direction(std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma));
      const double intensity_cd = light.intensity_cd(direction);
      require(std::isfinite(intensity_cd) && intensity_cd >= 0 && intensity_cd <= max_cd);
      require(gamma <= 0.5 * light.emission_cone_rad() + 1e-6 || intensity_cd == 0);
    }
  }
  for (int i = 0; i <= 16; ++i) {
    for (int j = 0; j <= 16; ++j) {
      const DirectionSample drawn = light.sample(i / 16.0, j / 16.0);
      require(std::abs(drawn.direction.norm() - 1) < 1e-9);
      require(std::isfinite(drawn.density_per_sr) && drawn.density_per_sr >= 0);
    }
  }
}

}  // namespace luxrig::fuzz
