#include "core/highlight/picture/feature_palette.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "core/check.h"

namespace luxrig {

std::vector<std::uint32_t> feature_colours(std::span<const OrientedPoint> points, const FeatureClusters& features,
                                           double near_m, std::uint32_t colours) {
  LUXRIG_CHECK(colours >= 1, "{} colours", colours);
  LUXRIG_CHECK(points.size() == features.cluster_of_point.size(), "{} points, {} of clusters", points.size(),
               features.cluster_of_point.size());
  // Finds near pairs by a sweep along x.
  std::vector<std::uint32_t> along(points.size());
  std::iota(along.begin(), along.end(), 0u);
  const auto x_of = [&](std::uint32_t i) { return points[i].position_world_m.x(); };
  std::ranges::stable_sort(along, {}, x_of);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < along.size(); ++i)
    for (std::size_t j = i + 1; j < along.size() && x_of(along[j]) - x_of(along[i]) <= near_m; ++j) {
      const std::uint32_t a = features.cluster_of_point[along[i]], b = features.cluster_of_point[along[j]];
      if (a == b) continue;
      const double apart_m = (points[along[i]].position_world_m - points[along[j]].position_world_m).norm();
      if (apart_m > near_m) continue;
      pairs.emplace_back(a, b);
      pairs.emplace_back(b, a);
    }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

  std::vector<std::uint32_t> order(features.sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::greater{}, [&](std::uint32_t c) { return features.sizes[c]; });
  constexpr std::uint32_t kNotYet = ~0u;
  std::vector<std::uint32_t> colour(features.sizes.size(), kNotYet), taken(colours);
  for (const std::uint32_t cluster : order) {
    std::ranges::fill(taken, 0u);
    auto pair = std::ranges::lower_bound(pairs, std::pair{cluster, 0u});
    for (; pair != pairs.end() && pair->first == cluster; ++pair)
      if (colour[pair->second] != kNotYet) ++taken[colour[pair->second]];
    colour[cluster] = static_cast<std::uint32_t>(std::ranges::min_element(taken) - taken.begin());
  }
  return colour;
}

}  // namespace luxrig
