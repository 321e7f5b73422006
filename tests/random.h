#pragma once
/// Random numbers, points and directions for tests.

#include <cmath>
#include <random>

#include "core/geometry.h"

namespace luxrig {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_); }

  /// In the cube from -1 to 1.
  Vec3 in_cube() {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return {x, y, z};
  }
  Vec3 direction() {
    const double z = between(-1, 1), angle = between(-kPi, kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  Mat3 rotation() {
    Mat3 m;
    const Vec3 z = direction(), x = z.cross(direction()).normalized();
    m << x, z.cross(x), z;
    return m;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace luxrig
