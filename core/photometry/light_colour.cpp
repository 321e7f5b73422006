#include "core/photometry/light_colour.h"

#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

/// Rec. 709 primaries, white D65.
Mat3 rgb_from_xyz() {
  Mat3 m;
  m << 3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108, 0.0415560, 0.0556434, -0.2040259, 1.0572252;
  return m;
}

}  // namespace

std::optional<Vec3> with_luminance_1(const Vec3& rgb) {
  const double luminance = luminance_of_rgb(rgb);
  if (!(luminance > 0) || !std::isfinite(luminance) || !(rgb.minCoeff() >= 0)) return std::nullopt;
  return Vec3(rgb / luminance);
}

Vec3 rgb_of_cct(double cct_k) {
  LUXRIG_CHECK(cct_k >= kMinCct_k && cct_k <= kMaxCct_k, "{} K", cct_k);
  const double t = 1000 / cct_k;
  const double x = cct_k < 4000 ? 0.179910 + t * (0.8776956 + t * (-0.2343589 - t * 0.2661239))
                                : 0.240390 + t * (0.2226347 + t * (2.1070379 - t * 3.0258469));
  const double y = cct_k < 2222   ? -0.20219683 + x * (2.18555832 + x * (-1.34811020 - x * 1.1063814))
                   : cct_k < 4000 ? -0.16748867 + x * (2.09137015 + x * (-1.37418593 - x * 0.9549476))
                                  : -0.37001483 + x * (3.75112997 + x * (-5.87338670 + x * 3.0817580));
  return within_rec709(rgb_of_xy({x, y})).rgb;
}

Vec3 rgb_of_xy(const Chromaticity& xy) {
  LUXRIG_CHECK(xy.y() > 0, "y of a chromaticity is {}", xy.y());
  const Vec3 rgb = rgb_from_xyz() * Vec3(xy.x() / xy.y(), 1, (1 - xy.x() - xy.y()) / xy.y());
  return rgb / luminance_of_rgb(rgb);
}

Chromaticity xy_of_rgb(const Vec3& rgb) {
  static const Mat3 xyz_from_rgb = rgb_from_xyz().inverse();
  const Vec3 xyz = xyz_from_rgb * rgb;
  return xyz.head<2>() / xyz.sum();
}

ColourWithin709 within_rec709(const Vec3& rgb) {
  // Published chromaticities of the primaries themselves have only three digits.
  constexpr double kRounding = 2e-3;
  return {*with_luminance_1(rgb.cwiseMax(0.0)), rgb.minCoeff() < -kRounding * rgb.maxCoeff()};
}

}  // namespace luxrig
