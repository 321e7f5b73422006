#include "tools/bench/analytic/reference_sky.h"

#include <algorithm>
#include <cmath>

#include "tools/bench/analytic/closed_forms.h"

namespace luxrig {

// Gradation a, b and indicatrix c, d, e of the standard's table 1.
const ReferenceSky::Parameters ReferenceSky::kTypes[15] = {
    {4.0, -0.70, 0, -1.0, 0.00},   {4.0, -0.70, 2, -1.5, 0.15},   {1.1, -0.80, 0, -1.0, 0.00},
    {1.1, -0.80, 2, -1.5, 0.15},   {0.0, -1.00, 0, -1.0, 0.00},   {0.0, -1.00, 2, -1.5, 0.15},
    {0.0, -1.00, 5, -2.5, 0.30},   {0.0, -1.00, 10, -3.0, 0.45},  {-1.0, -0.55, 2, -1.5, 0.15},
    {-1.0, -0.55, 5, -2.5, 0.30},  {-1.0, -0.55, 10, -3.0, 0.45}, {-1.0, -0.32, 10, -3.0, 0.45},
    {-1.0, -0.32, 16, -3.0, 0.30}, {-1.0, -0.15, 16, -3.0, 0.30}, {-1.0, -0.15, 24, -2.8, 0.15}};

ReferenceSky::ReferenceSky(int type, const Vec3& towards_sun_world, double zenith_cd_m2)
    : type_(kTypes[type - 1]), sun_(towards_sun_world.normalized()) {
  scale_cd_m2_ = zenith_cd_m2 / luminance_cd_m2(Vec3::UnitZ());
  const GaussNodes rule = gauss_rule(96);
  horizontal_lx_ = integral(rule, 0, 1, 0, 2 * kPi, [&](double up, double turn) {
    const double flat = std::sqrt(1 - up * up);
    return up * luminance_cd_m2({flat * std::cos(turn), flat * std::sin(turn), up});
  });
}

double ReferenceSky::luminance_cd_m2(const Vec3& direction) const {
  if (!(direction.z() > 0)) return 0;
  const double chi = std::acos(std::clamp(direction.dot(sun_), -1.0, 1.0)), cosine = std::cos(chi);
  const double gradation = 1 + type_.a * std::exp(type_.b / direction.z());
  const double indicatrix =
      1 + type_.c * (std::exp(type_.d * chi) - std::exp(type_.d * kPi / 2)) + type_.e * cosine * cosine;
  return scale_cd_m2_ * gradation * indicatrix;
}

}  // namespace luxrig
