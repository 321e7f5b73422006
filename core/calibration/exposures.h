#pragma once
/// Pictures of the same light at several exposures, as one.

#include <cstddef>
#include <span>
#include <vector>

#include "core/picture/picture.h"

namespace luxrig {

/// longest_first: at least one, of one size (asserted), all in cd/m². Where an exposure is full, the next shorter one
/// counts.
[[nodiscard]] Picture merged_exposures(std::span<const Picture> longest_first);

/// The light of all exposures, and where even the shortest is full: of those pixels nobody knows how bright they are.
struct MergedPicture {
  Picture picture;
  std::vector<bool> full;  ///< per pixel; empty = none

  [[nodiscard]] double full_share() const;  ///< of all pixels
};

/// full_pixels: how many of the shortest exposure are full; they are its brightest, since no sample shows more.
[[nodiscard]] MergedPicture merged_with_full(std::span<const Picture> longest_first, std::size_t full_pixels);

/// How many pixels are full, of a picture that does not say it: noise spreads samples, so that more with exactly the
/// largest value than with the next smaller one were cut there.
[[nodiscard]] std::size_t cut_pixels(const Picture& picture);

}  // namespace luxrig
