#pragma once
/// Colour of light in linear Rec. 709, scaled to a luminance of 1.

#include <optional>

#include "core/geometry.h"

namespace luxrig {

/// Luminance of a linear Rec. 709 colour.
[[nodiscard]] inline double luminance_of_rgb(const Vec3& rgb) {
  return 0.2126 * rgb.x() + 0.7152 * rgb.y() + 0.0722 * rgb.z();
}

/// `rgb` scaled to a luminance of 1; nullopt if it has none, or is negative or not finite.
[[nodiscard]] std::optional<Vec3> with_luminance_1(const Vec3& rgb);

inline constexpr double kMinCct_k = 1667, kMaxCct_k = 25000;

/// Chromaticity, CIE 1931 2° observer.
using Chromaticity = Eigen::Vector2d;  ///< x, y

/// Colour of a chromaticity, with a luminance of 1. A primary is negative if the colour is outside Rec. 709.
/// requires   y > 0 (asserted)
[[nodiscard]] Vec3 rgb_of_xy(const Chromaticity& xy);
/// The inverse, for any luminance. requires   a positive sum of tristimulus values, as any light has
[[nodiscard]] Chromaticity xy_of_rgb(const Vec3& rgb);

/// A colour usable in computation: negative primaries set to 0, luminance 1.
struct ColourWithin709 {
  Vec3 rgb;
  bool moved = false;  ///< it was outside by more than rounding
};
[[nodiscard]] ColourWithin709 within_rec709(const Vec3& rgb);

/// Colour of a black body. Negative primaries (below 1900 K) are set to 0.
/// requires   kMinCct_k ≤ cct_k ≤ kMaxCct_k (asserted)
/// accuracy   0.001 in x and y
/// source     cubic fit of the Planckian locus by Kim et al., US patent 7024034 (2006); Rec. 709 primaries, white D65
[[nodiscard]] Vec3 rgb_of_cct(double cct_k);

}  // namespace luxrig
