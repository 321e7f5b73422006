#include "core/highlight/shadow/contrast_samples.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

ContrastSamples one_ring_samples(const TargetSurface& surface, std::span<const std::uint32_t> interest) {
  ContrastSamples samples;
  samples.interest = interest.size();
  std::vector<std::uint32_t> place(surface.points_m.size(), TargetSurface::kNone);
  const auto add = [&](std::uint32_t point) {
    LUXRIG_CHECK(point < place.size(), "point {} of {}", point, place.size());
    if (place[point] != TargetSurface::kNone) return;
    place[point] = static_cast<std::uint32_t>(samples.points.size());
    samples.points.push_back({surface.point_world_m(point), surface.normals[point]});
  };
  for (const std::uint32_t i : interest) add(i);
  LUXRIG_CHECK(samples.points.size() == interest.size(), "{} interest points, {} of them different", interest.size(),
               samples.points.size());
  for (const std::uint32_t i : interest) {
    for (const std::uint32_t neighbour : surface.ring(i)) {
      add(neighbour);
      samples.neighbours.push_back(place[neighbour]);
    }
    samples.begin.push_back(static_cast<std::uint32_t>(samples.neighbours.size()));
  }
  return samples;
}

SampleContrast contrast_of(const ContrastSamples& samples, std::span<const float> lux) {
  LUXRIG_CHECK(lux.size() == samples.points.size(), "{} for {} points", lux.size(), samples.points.size());
  double mean_lx = 0;
  for (const float lx : lux) mean_lx += lx;
  mean_lx /= static_cast<double>(std::max<std::size_t>(1, lux.size()));
  SampleContrast sum;
  for (std::size_t i = 0; i < samples.interest; ++i) {
    double largest_lx = 0, largest_share = 0;
    for (const std::uint32_t n : samples.of(i)) {
      const double difference_lx = std::abs(lux[i] - lux[n]);
      const double adapted_lx = std::max({static_cast<double>(lux[i]), static_cast<double>(lux[n]), mean_lx});
      largest_lx = std::max(largest_lx, difference_lx);
      if (adapted_lx > 0) largest_share = std::max(largest_share, difference_lx / adapted_lx);
    }
    sum.local_contrast_lx += largest_lx;
    sum.exposed_contrast += largest_share;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, samples.interest));
  return {sum.local_contrast_lx / count, sum.exposed_contrast / count};
}

std::size_t number_at_peak(std::span<const double> exposed_contrast) {
  constexpr double kAsGood = 0.98;
  if (exposed_contrast.empty()) return 0;
  const double peak = *std::max_element(exposed_contrast.begin(), exposed_contrast.end());
  const auto first = std::ranges::find_if(exposed_contrast, [&](double one) { return one >= kAsGood * peak; });
  return static_cast<std::size_t>(first - exposed_contrast.begin());
}

double local_contrast_of(const ContrastSamples& samples, std::span<const float> lux) {
  LUXRIG_CHECK(lux.size() == samples.points.size(), "{} for {} points", lux.size(), samples.points.size());
  double sum_lx = 0;
  for (std::size_t i = 0; i < samples.interest; ++i) {
    const float mine = lux[i];
    float largest_lx = 0;
    for (const std::uint32_t n : samples.of(i)) largest_lx = std::max(largest_lx, std::abs(mine - lux[n]));
    sum_lx += largest_lx;
  }
  return sum_lx / static_cast<double>(std::max<std::size_t>(1, samples.interest));
}

}  // namespace luxrig
