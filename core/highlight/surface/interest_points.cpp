#include "core/highlight/surface/interest_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

bool is_recessed(const Curvature& c, double min_turn_rad) {
  if (!c.known()) return false;
  const double depth_per_m = -c.mean_per_m();
  return depth_per_m * c.radius_m > min_turn_rad && depth_per_m > 2 * c.mean_error_per_m;
}

/// The most recessed point of each occupied cell; by_depth is in order of depth.
std::vector<std::uint32_t> one_per_cell(const TargetSurface& surface, const std::vector<std::uint32_t>& by_depth,
                                        double cell_m) {
  using Key = std::array<std::int64_t, 3>;
  std::vector<std::pair<Key, std::uint32_t>> cells;  // with the index in by_depth
  for (std::uint32_t k = 0; k < by_depth.size(); ++k) {
    Key key;
    for (int axis = 0; axis < 3; ++axis)
      key[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor(surface.points_m[by_depth[k]][axis] / cell_m));
    cells.emplace_back(key, k);
  }
  std::sort(cells.begin(), cells.end());
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || cells[i].first != cells[i - 1].first) kept.push_back(by_depth[cells[i].second]);
  return kept;
}

}  // namespace

Result<std::vector<std::uint32_t>> interest_points(const TargetSurface& surface,
                                                   const std::vector<Curvature>& curvature,
                                                   const InterestOptions& options) {
  const auto& below = options.mean_curvature_below_per_m;
  if (curvature.size() != surface.points_m.size())
    return refusal(fmt::format("{} curvatures for {} points", curvature.size(), surface.points_m.size()));
  if (below && !(*below < 0))
    return refusal(fmt::format("recessed places have a mean curvature below 0, not below {}", *below));
  if (!below && !(options.wanted_share >= 0 && options.wanted_share <= 1))
    return refusal(fmt::format("share of the surface {} is not within 0 to 1", options.wanted_share));

  std::vector<std::uint32_t> points;
  double known_m2 = 0;
  for (std::uint32_t i = 0; i < curvature.size(); ++i) {
    if (curvature[i].known()) known_m2 += surface.areas_m2[i];
    if (is_recessed(curvature[i], options.min_turn_rad) && (!below || curvature[i].mean_per_m() < *below))
      points.push_back(i);
  }
  std::stable_sort(points.begin(), points.end(), [&](std::uint32_t i, std::uint32_t j) {
    return curvature[i].mean_per_m() < curvature[j].mean_per_m();
  });
  if (!below) {
    double sum_m2 = 0;
    std::size_t count = 0;
    while (count < points.size() && sum_m2 + surface.areas_m2[points[count]] / 2 <= options.wanted_share * known_m2)
      sum_m2 += surface.areas_m2[points[count++]];
    points.resize(count);
  }
  if (options.max_points > 0 && points.size() > options.max_points) {
    // The finest grid that keeps the limit, to a hundredth of its cell.
    double fine_m = 0, coarse_m = 2 * surface.diagonal_m();
    std::vector<std::uint32_t> kept = {points.front()};
    for (int round = 0; round < 60 && coarse_m - fine_m > 0.01 * coarse_m; ++round) {
      const double middle_m = fine_m > 0 ? (fine_m + coarse_m) / 2 : coarse_m / 2;
      std::vector<std::uint32_t> tried = one_per_cell(surface, points, middle_m);
      if (tried.size() <= options.max_points) {
        coarse_m = middle_m;
        kept = std::move(tried);
      } else {
        fine_m = middle_m;
      }
    }
    points = std::move(kept);
  }
  std::sort(points.begin(), points.end());
  return points;
}

}  // namespace luxrig
