#pragma once
/// Fast angle of a plane vector, since intensity lookups spend most of their time on it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry.h"

namespace luxrig {
namespace arc_tangent {

inline constexpr int kSteps = 64;

/// Euler's series  atan x = Σ 2²ⁿ (n!)² / (2n+1)! · x²ⁿ⁺¹ / (1+x²)ⁿ⁺¹: each term is at most half the previous one for x
/// ≤ 1.
constexpr double euler(double x) {
  const double ratio = x * x / (1 + x * x);
  double term = x / (1 + x * x);
  double sum = 0;
  for (int n = 0; n < 70; ++n) {
    sum += term;
    term *= ratio * (2 * n + 2) / (2 * n + 3);
  }
  return sum;
}

constexpr std::array<double, kSteps + 1> table() {
  std::array<double, kSteps + 1> values{};
  for (int k = 0; k <= kSteps; ++k) values[static_cast<std::size_t>(k)] = euler(static_cast<double>(k) / kSteps);
  return values;
}
inline constexpr std::array<double, kSteps + 1> kTable = table();

}  // namespace arc_tangent

/// Angle [rad, 0…π] from +X of the vector (x, y); 0 for the zero vector. Equals std::atan2 to 5e-16, without its
/// branches, which random directions mispredict: atan q = atan(k/64) + atan((q - k/64) / (1 + q k/64)), whose last term
/// is a short series.
/// requires y ≥ 0 and both finite
inline double angle_rad(double y, double x) {
  const double width = std::abs(x);
  const double least = std::min(y, width);
  const double most = std::max(std::max(y, width), 1e-300);
  const int k = static_cast<int>(static_cast<float>(arc_tangent::kSteps) * static_cast<float>(least / most) + 0.5f);
  const double t = (arc_tangent::kSteps * least - k * most) / (arc_tangent::kSteps * most + k * least);
  const double t2 = t * t;  // |t| ≤ 1/128: the next term is below 3e-16
  const double octant = arc_tangent::kTable[static_cast<std::size_t>(k)] + t * (1 - t2 * (1.0 / 3 - t2 * (1.0 / 5)));
  // 0…45° directly; up to 90°, 135° and 180° by reflection.
  constexpr std::array<double, 4> kFrom = {0, 0.5 * kPi, kPi, 0.5 * kPi};
  constexpr std::array<double, 4> kSign = {1, -1, -1, 1};
  const std::size_t which = static_cast<std::size_t>(y > width) + 2 * static_cast<std::size_t>(x < 0);
  return kFrom[which] + kSign[which] * octant;
}

}  // namespace luxrig
