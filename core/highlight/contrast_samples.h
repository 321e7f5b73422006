#pragma once
/// Where local contrast is looked at: interest points, and what each is compared with.

#include "core/highlight/shadow_edges.h"
#include "core/highlight/target_surface.h"

namespace luxrig {

struct ContrastSamples {
  std::vector<OrientedPoint> points;       ///< each once: interest points, then those that are neighbours only
  std::size_t interest = 0;                ///< so many of the points are interest points
  std::vector<std::uint32_t> begin = {0};  ///< per interest point, and one more
  std::vector<std::uint32_t> neighbours;   ///< indices of points
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t interest_point) const {
    return std::span(neighbours).subspan(begin[interest_point], begin[interest_point + 1] - begin[interest_point]);
  }
};

/// Compared with their one-ring, as `relief_contrast` does.
/// interest   indices of points of the surface, each once
[[nodiscard]] ContrastSamples one_ring_samples(const TargetSurface& surface, std::span<const std::uint32_t> interest);

}  // namespace luxrig
