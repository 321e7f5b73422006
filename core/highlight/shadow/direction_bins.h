#pragma once
/// The sphere of directions in cells of equal area, and votes in them.

#include <cstdint>
#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"

namespace luxrig {

/// HEALPix, rings from +Z down (K. Górski et al., "HEALPix: a framework for high-resolution discretization …", 2005, §5
/// and equations 4 to 9): 12 · side² cells of exactly equal area, all nearly square.
class DirectionBins {
 public:
  explicit DirectionBins(int side = 16);  ///< 3 072 cells, 3.7° wide; 1…1024 (asserted)
  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] std::uint32_t count() const { return 12u * static_cast<std::uint32_t>(side_ * side_); }
  [[nodiscard]] std::uint32_t bin_of(const Vec3& direction) const;  ///< need not be unit; not zero
  [[nodiscard]] Vec3 direction_of(std::uint32_t bin) const;         ///< the centre of a cell, unit

 private:
  int side_;
};

struct DirectionHistogram {
  DirectionBins bins;
  std::vector<std::uint32_t> votes;  ///< per bin
  std::vector<Vec3> mean_direction;  ///< per bin, unit, of its votes; zero if it has none
  [[nodiscard]] std::uint64_t total() const;
};

/// One vote per edge, along its open ray. The result does not depend on the number of threads.
[[nodiscard]] DirectionHistogram vote_directions(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                                                 const DirectionBins& bins, int threads);

/// Difference of two histograms over the same bins, as a share of the second's votes: Σ |a - b| / Σ b. 0 when both are
/// empty.
[[nodiscard]] double histogram_error(const DirectionHistogram& a, const DirectionHistogram& b);

}  // namespace luxrig
