#include "core/photometry/light_colour.h"

#include <gtest/gtest.h>

#include <limits>

namespace luxrig {
namespace {

/// Chromaticity of a linear Rec. 709 colour, by the matrix of its primaries (IEC 61966-2-1).
std::pair<double, double> chromaticity(const Vec3& rgb) {
  const double x = 0.4124564 * rgb.x() + 0.3575761 * rgb.y() + 0.1804375 * rgb.z();
  const double y = 0.2126729 * rgb.x() + 0.7151522 * rgb.y() + 0.0721750 * rgb.z();
  const double z = 0.0193339 * rgb.x() + 0.1191920 * rgb.y() + 0.9503041 * rgb.z();
  return {x / (x + y + z), y / (x + y + z)};
}

TEST(LightColour, OfBlackBodiesFollowsThePlanckianLocus) {
  // CIE 15: illuminant A (2856 K) and the locus at round temperatures.
  const struct {
    double cct_k, x, y;
  } points[] = {{2856, 0.4476, 0.4074},
                {2000, 0.5267, 0.4133},
                {4000, 0.3805, 0.3768},
                {6500, 0.3135, 0.3237},
                {10000, 0.2807, 0.2884}};
  for (const auto& point : points) {
    const auto [x, y] = chromaticity(rgb_of_cct(point.cct_k));
    EXPECT_NEAR(x, point.x, 1e-3) << point.cct_k;
    EXPECT_NEAR(y, point.y, 1e-3) << point.cct_k;
  }
}

TEST(LightColour, AlwaysHasALuminanceOfOneAndNoNegativePrimary) {
  double blue_before = -1;
  for (double cct_k = kMinCct_k; cct_k <= kMaxCct_k; cct_k += 37) {
    const Vec3 rgb = rgb_of_cct(cct_k);
    EXPECT_NEAR(luminance_of_rgb(rgb), 1, 1e-12);
    EXPECT_GE(rgb.minCoeff(), 0);
    EXPECT_GE(rgb.z(), blue_before - 1e-3) << cct_k;
    blue_before = rgb.z();
  }
}

TEST(LightColour, ScalesAnyColourExceptBlackAndImpossibleOnes) {
  EXPECT_NEAR(luminance_of_rgb(*with_luminance_1(Vec3(0, 0, 3))), 1, 1e-12);
  EXPECT_FALSE(with_luminance_1(Vec3::Zero()).has_value());
  EXPECT_FALSE(with_luminance_1(Vec3(1, -0.1, 1)).has_value());
  EXPECT_FALSE(with_luminance_1(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())).has_value());
  EXPECT_FALSE(with_luminance_1(Vec3::Constant(std::numeric_limits<double>::infinity())).has_value());
}

}  // namespace
}  // namespace luxrig
