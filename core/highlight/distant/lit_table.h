#pragma once
/// Directions from which light reaches each place: one bit per place and direction. With this table, the local contrast
/// of any lights is arithmetic, without rays.

#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/shadow/direction_bins.h"
#include "core/run.h"

namespace luxrig {

struct LitTableOptions : Run {
  bool every_ray = false;  ///< no search: one ray for each place and each bin that it faces
  double lift_m = 0;       ///< rays start this far off the surface
};

struct LitTable {
  DirectionBins bins;
  std::size_t words = 0;            ///< per place
  std::vector<std::uint64_t> rows;  ///< bit b of a place: light from the centre of bin b reaches it
  std::uint64_t rays = 0;           ///< cast
  [[nodiscard]] std::span<const std::uint64_t> of(std::size_t point) const {
    return std::span(rows).subspan(point * words, words);
  }
  [[nodiscard]] bool lit(std::size_t point, std::uint32_t bin) const {
    return rows[point * words + bin / 64] >> (bin % 64) & 1u;
  }
};

/// Bins that a place faces away from do not light it. A place without a normal is lit by none.
///
/// Search: an interest point gets rays to about every fourth bin, at twice the bin spacing; bins between take the
/// result of the nearest ray. Then each bin that differs from a neighbour is traced, until both bins of every such pair
/// have been. Other places start from the result of their first interest point, so they trace only along its borders.
/// The search misses patches that no first ray met. The result does not depend on the number of threads. Fails only
/// when stopped.
[[nodiscard]] Result<LitTable> find_lit_bins(const TargetRays& target, const ContrastSamples& samples,
                                             const DirectionBins& bins, const LitTableOptions& options);

}  // namespace luxrig
