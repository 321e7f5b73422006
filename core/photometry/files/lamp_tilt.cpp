#include "core/photometry/files/lamp_tilt.h"

#include <algorithm>

#include "core/geometry.h"

namespace luxrig {

double LampTilt::over_upright(double tilt_rad) const {
  double deg = std::clamp(deg_from_rad(tilt_rad), 0.0, 180.0);
  if (angle_deg.back() == 90 && deg > 90) deg = 180 - deg;
  if (deg <= angle_deg.front()) return 1;
  if (deg >= angle_deg.back()) return factor.back() / factor.front();
  const auto above = std::upper_bound(angle_deg.begin(), angle_deg.end(), deg);
  const auto i = static_cast<std::size_t>(above - angle_deg.begin());
  const double t = (deg - angle_deg[i - 1]) / (angle_deg[i] - angle_deg[i - 1]);
  return (factor[i - 1] + t * (factor[i] - factor[i - 1])) / factor.front();
}

}  // namespace luxrig
