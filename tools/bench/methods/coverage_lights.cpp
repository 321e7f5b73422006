#include "tools/bench/methods/coverage_lights.h"

#include <algorithm>

#include "core/parallel.h"

namespace luxrig {

std::vector<CoverageLight> coverage_lights(const TargetSurface& surface, const TargetRays& target,
                                           const DirectionBins& bins, int lights, std::size_t max_points, int threads) {
  const std::size_t all = surface.points_m.size();
  const std::size_t count = max_points == 0 ? all : std::min(all, max_points);
  std::vector<Vec3f> directions;
  for (std::uint32_t b = 0; b < bins.count(); ++b) directions.push_back(bins.direction_of(b).cast<float>());

  std::vector<std::uint32_t> points;
  double area_m2 = 0;
  for (std::size_t k = 0; k < count; ++k) {
    points.push_back(static_cast<std::uint32_t>(k * all / count));
    area_m2 += surface.areas_m2[points.back()];
  }
  std::vector<std::vector<std::uint32_t>> lit_by(points.size());  // bins, per point
  parallel_for(points.size(), threads, [&](std::size_t k) {
    const Vec3& normal = surface.normals[points[k]];
    if (normal.isZero(0)) return;
    std::vector<std::uint32_t> facing;
    std::vector<Vec3f> asked;
    for (std::uint32_t b = 0; b < directions.size(); ++b) {
      if (directions[b].dot(normal.cast<float>()) <= 0) continue;
      facing.push_back(b);
      asked.push_back(directions[b]);
    }
    std::vector<std::uint8_t> blocked(asked.size());
    target.blocked(surface.point_world_m(points[k]), normal, 0, asked, blocked);
    for (std::size_t i = 0; i < facing.size(); ++i)
      if (!blocked[i]) lit_by[k].push_back(facing[i]);
  });

  std::vector<CoverageLight> chosen;
  std::vector<double> votes_m2(bins.count(), 0);
  for (std::size_t k = 0; k < points.size(); ++k)
    for (const std::uint32_t b : lit_by[k]) votes_m2[b] += surface.areas_m2[points[k]];
  for (int round = 0; round < lights; ++round) {
    const auto best = static_cast<std::uint32_t>(std::max_element(votes_m2.begin(), votes_m2.end()) - votes_m2.begin());
    double gained_m2 = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!std::binary_search(lit_by[k].begin(), lit_by[k].end(), best)) continue;
      gained_m2 += surface.areas_m2[points[k]];
      for (const std::uint32_t b : lit_by[k]) votes_m2[b] -= surface.areas_m2[points[k]];
      lit_by[k].clear();
    }
    if (!(gained_m2 > 0)) break;
    votes_m2[best] = 0;
    chosen.push_back({bins.direction_of(best), gained_m2 / area_m2});
  }
  return chosen;
}

}  // namespace luxrig
