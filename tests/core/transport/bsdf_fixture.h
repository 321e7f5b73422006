#pragma once
/// Shared by the tests of bsdf.

#include "core/transport/bsdf.h"

namespace luxrig::bsdf_fixture {

inline Material glossy(double specular, double roughness, double body) {
  Material material{"varnish", Vec3::Constant(body)};
  material.specular_reflectance = specular;
  material.roughness = roughness;
  return material;
}

inline Vec3 direction(double cosine, double angle_rad) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(angle_rad), sine * std::sin(angle_rad), cosine};
}

/// ∫ f cosθ dω over the hemisphere on a fine grid in cosine and angle. Uses no sampling.
inline double brute_albedo(const Bsdf& bsdf, const Vec3& out) {
  constexpr int kCosines = 1000, kAngles = 1000;
  double sum = 0;
  for (int i = 0; i < kCosines; ++i)
    for (int j = 0; j < kAngles; ++j) {
      const double cosine = (i + 0.5) / kCosines;
      sum += bsdf.value(Vec3::UnitZ(), out, direction(cosine, 2 * kPi * (j + 0.5) / kAngles)).x() * cosine;
    }
  return sum * 2 * kPi / (double{kCosines} * kAngles);
}

inline const double kCosines[] = {1.0, 0.8, 0.4, 0.1};

}  // namespace luxrig::bsdf_fixture
