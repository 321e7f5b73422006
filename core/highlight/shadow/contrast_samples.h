#pragma once
/// Where local contrast is looked at: interest points, and what each is compared with.

#include "core/highlight/shadow/shadow_edges.h"
#include "core/highlight/surface/target_surface.h"

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

/// Of some light on the samples.
struct SampleContrast {
  double local_contrast_lx = 0;  ///< largest difference in illuminance to a neighbour, mean over interest points
  /// The same as a share of the brighter of the two, or of the mean illuminance of all points where that is more: what
  /// is left of it in a picture exposed for the whole object. 0…1; unlike lux it does not rise with every light.
  double exposed_contrast = 0;
};

/// lux   at each of the samples' points
[[nodiscard]] SampleContrast contrast_of(const ContrastSamples& samples, std::span<const float> lux);
/// Which number of lights to take, by the exposed contrast of one, two, …: the fewest that are within 2 % of the peak,
/// since that much is less than a light is worth. An index; 0 of none.
[[nodiscard]] std::size_t number_at_peak(std::span<const double> exposed_contrast);
/// The first of the two alone, in less time.
[[nodiscard]] double local_contrast_of(const ContrastSamples& samples, std::span<const float> lux);

/// Compared with their ring(), as `relief_contrast` does.
/// interest   indices of points of the surface, each once
[[nodiscard]] ContrastSamples one_ring_samples(const TargetSurface& surface, std::span<const std::uint32_t> interest);

}  // namespace luxrig
