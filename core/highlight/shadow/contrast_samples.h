#pragma once
/// Samples for local contrast: interest points and the neighbours they are compared with.

#include "core/highlight/shadow/shadow_edges.h"
#include "core/highlight/surface/target_surface.h"

namespace luxrig {

struct ContrastSamples {
  std::vector<OrientedPoint> points;       ///< each once: interest points, then points that are only neighbours
  std::size_t interest = 0;                ///< number of interest points
  std::vector<std::uint32_t> begin = {0};  ///< per interest point, plus one
  std::vector<std::uint32_t> neighbours;   ///< indices of points
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t interest_point) const {
    return std::span(neighbours).subspan(begin[interest_point], begin[interest_point + 1] - begin[interest_point]);
  }
};

/// Contrast of given light on the samples.
struct SampleContrast {
  double local_contrast_lx = 0;  ///< largest difference in illuminance to a neighbour, mean over interest points
  /// The same as a share of the brighter of the two, or of the mean illuminance of all points if that is more: the
  /// contrast left in a picture exposed for the whole object. 0…1; unlike lux, it does not rise with every light.
  double exposed_contrast = 0;
};

/// lux   at each of the samples' points
[[nodiscard]] SampleContrast contrast_of(const ContrastSamples& samples, std::span<const float> lux);
/// Index of the recommended number of lights, by the exposed contrast of one, two, …: the fewest within 2 % of the
/// peak, since a light should gain more than that. 0 if empty.
[[nodiscard]] std::size_t number_at_peak(std::span<const double> exposed_contrast);
/// Only local_contrast_lx, in less time.
[[nodiscard]] double local_contrast_of(const ContrastSamples& samples, std::span<const float> lux);

/// Interest points compared with their ring(), as in `relief_contrast`.
/// interest   indices of points of the surface, each once
[[nodiscard]] ContrastSamples one_ring_samples(const TargetSurface& surface, std::span<const std::uint32_t> interest);

}  // namespace luxrig
