#pragma once
/// Shared by the tests of glass.

#include "core/transport/evaluator.h"

namespace luxrig::glass_fixture {

inline constexpr double kHalf_m = 1.5;

/// A pane across the whole cube.
inline std::vector<Pane> pane_at(double z_m, double transmittance) {
  const Vec3 a(-2, -2, z_m), b(2, -2, z_m), c(2, 2, z_m), d(-2, 2, z_m);
  return {{{a, b, c}, transmittance, 0}, {{a, c, d}, transmittance, 0}};
}

inline Emitter bulb_at(const Vec3& position_m) { return {make_isotropic(1000), {Mat3::Identity(), position_m}}; }

inline std::vector<Receiver> some_receivers() {
  return {{{0.2, -0.4, -kHalf_m}, Vec3::UnitZ()},
          {{-kHalf_m, 0.3, -0.5}, Vec3::UnitX()},
          {{0.5, kHalf_m, 0.9}, -Vec3::UnitY()},
          {{-0.6, 0.1, 0.1}, -Vec3::UnitZ()}};
}

}  // namespace luxrig::glass_fixture
