#pragma once
/// Lamps whose output depends on how they hang.

#include <vector>

namespace luxrig {

/// How a lamp's output depends on how far its luminaire hangs off upright (TILT=INCLUDE).
struct LampTilt {
  /// 1: the lamp stands upright, 2: it lies and keeps lying when the luminaire is tilted, 3: it lies and is tilted with
  /// the luminaire. The angles below are the luminaire's in all three.
  int geometry = 1;
  std::vector<double> angle_deg;  ///< ascending, 0…180
  std::vector<double> factor;     ///< 0.001…10

  /// Factor at a tilt [rad, 0…π], over the factor of an upright luminaire: linear between the angles, held beyond them;
  /// a list that ends at 90° is mirrored there.
  [[nodiscard]] double over_upright(double tilt_rad) const;
};

}  // namespace luxrig
