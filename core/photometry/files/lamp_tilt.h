#pragma once
/// Lamps whose output depends on their orientation.

#include <vector>

namespace luxrig {

/// A lamp's output by the tilt of its luminaire from upright (TILT=INCLUDE).
struct LampTilt {
  /// The angles below are the luminaire's in all three cases.
  ///   1   the lamp is upright
  ///   2   it is horizontal, and stays so when the luminaire is tilted
  ///   3   it is horizontal, and tilts with the luminaire
  int geometry = 1;
  std::vector<double> angle_deg;  ///< ascending, 0…180
  std::vector<double> factor;     ///< 0.001…10

  /// Factor at a tilt [rad, 0…π] over the factor of an upright luminaire. Linear between the angles, constant beyond
  /// them. A list that ends at 90° is mirrored there.
  [[nodiscard]] double over_upright(double tilt_rad) const;
};

}  // namespace luxrig
