#pragma once
/// Local contrast from a table of lit directions: exact sums, no rays.

#include "core/highlight/distant/lit_table.h"

namespace luxrig {

/// Largest differences in illuminance to a neighbour, as in `relief_contrast`.
class TabledContrast {
 public:
  /// Both must outlive it.
  TabledContrast(const ContrastSamples& samples, const LitTable& table, int threads);

  /// Illuminance at each sample point from beams of 1 lx out of the centres of bins [lx].
  [[nodiscard]] std::vector<float> illuminance_lx(std::span<const std::uint32_t> bins) const;

  /// Contrast of beams of 1 lx, each out of the centre of a bin.
  [[nodiscard]] SampleContrast of(std::span<const std::uint32_t> bins) const;

  /// Local contrast [lx] with a beam of 1 lx from each bin in turn added to the base; one per bin. The result is
  /// bit-identical for any number of threads.
  /// base_lx   per point; empty = darkness
  [[nodiscard]] std::vector<double> with_each_bin(std::span<const float> base_lx) const;

 private:
  const ContrastSamples& samples_;
  const LitTable& table_;
  int threads_;
  std::vector<float> x_, y_, z_;  // of bins' directions
};

}  // namespace luxrig
