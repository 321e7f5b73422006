#pragma once
/// Closed form of a move from rest to rest over `distance` that never exceeds `speed` and `acceleration` (both > 0; the
/// same acceleration up and down):
///
///   d ≥ v²/a   speed is reached:      T = d/v + v/a
///   d < v²/a   it is not (triangle):  T = 2·√(d/a)
///
/// Any unit of length works if all three share it.

#include <cmath>

namespace luxrig {

/// Seconds from rest to rest. distance ≥ 0.
[[nodiscard]] inline double trapezoid_s(double distance, double speed, double acceleration) {
  if (distance * acceleration >= speed * speed) return distance / speed + speed / acceleration;
  return 2 * std::sqrt(distance / acceleration);
}

}  // namespace luxrig
