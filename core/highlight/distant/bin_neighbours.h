#pragma once
/// Neighbouring bins of the sphere.

#include "core/highlight/shadow/direction_bins.h"

namespace luxrig {

struct BinNeighbours {
  std::vector<std::uint32_t> begin = {0}, bins;
  /// Neighbours without the bin itself, rising.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t bin) const {
    return std::span(bins).subspan(begin[bin], begin[bin + 1] - begin[bin]);
  }
};

/// Bins whose centres are within the angle (0…π) of each other.
[[nodiscard]] BinNeighbours bins_within(const DirectionBins& bins, double angle_rad);

/// Width of a bin: side of a square with its solid angle.
[[nodiscard]] double bin_width_rad(const DirectionBins& bins);

}  // namespace luxrig
