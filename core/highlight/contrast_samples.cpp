#include "core/highlight/contrast_samples.h"

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

}  // namespace luxrig
