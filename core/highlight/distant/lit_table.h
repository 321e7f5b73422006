#pragma once
/// From which directions light reaches each place: a bit per place and direction. With it the local contrast of any
/// lights is arithmetic, without rays.

#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/shadow/direction_bins.h"
#include "core/run.h"

namespace luxrig {

struct LitTableOptions : Run {
  bool every_ray = false;  ///< no search: a ray for each place and each bin that it faces
  double lift_m = 0;       ///< rays start so far off the surface
};

struct LitTable {
  DirectionBins bins;
  std::size_t words = 0;            ///< per place
  std::vector<std::uint64_t> rows;  ///< bit b of a place: light from the middle of bin b reaches it
  std::uint64_t rays = 0;           ///< cast
  [[nodiscard]] std::span<const std::uint64_t> of(std::size_t point) const {
    return std::span(rows).subspan(point * words, words);
  }
  [[nodiscard]] bool lit(std::size_t point, std::uint32_t bin) const {
    return rows[point * words + bin / 64] >> (bin % 64) & 1u;
  }
};

/// A place is not lit from bins that it faces away from, and without a normal from none.
///
/// Search: at an interest point, rays to every fourth bin or so, twice as far apart as bins are; what lies between is
/// taken to be as the nearest of them. Then each bin that differs from one around it is asked, until every such pair
/// consists of two that were. Another place starts from what its first interest point found, so it asks along
/// that one's borders only. Missed are patches that no first ray met. The same answer for any number of threads.
/// Fails only when stopped.
[[nodiscard]] Result<LitTable> find_lit_bins(const TargetRays& target, const ContrastSamples& samples,
                                             const DirectionBins& bins, const LitTableOptions& options);

}  // namespace luxrig
