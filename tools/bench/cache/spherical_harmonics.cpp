#include "tools/bench/cache/spherical_harmonics.h"

namespace luxrig {

Harmonics harmonics(const Vec3& d) {
  constexpr double k0 = 0.28209479177387814;   // ½ √(1/π)
  constexpr double k1 = 0.48860251190291992;   // √(3/4π)
  constexpr double k2 = 1.0925484305920792;    // ½ √(15/π)
  constexpr double k20 = 0.31539156525252005;  // ¼ √(5/π)
  Harmonics y;
  y << k0, k1 * d.y(), k1 * d.z(), k1 * d.x(), k2 * d.x() * d.y(), k2 * d.y() * d.z(), k20 * (3 * d.z() * d.z() - 1),
      k2 * d.x() * d.z(), k2 / 2 * (d.x() * d.x() - d.y() * d.y());
  return y;
}

Harmonics cosine_lobe(const Vec3& axis) {
  Harmonics lobe = harmonics(axis);
  lobe[0] *= kPi;
  lobe.segment<3>(1) *= 2 * kPi / 3;
  lobe.segment<5>(4) *= kPi / 4;
  return lobe;
}

}  // namespace luxrig
