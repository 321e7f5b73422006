#include "core/highlight/relief_contrast.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerContrastTask = 256;
constexpr std::uint32_t kNotAsked = ~0u;

}  // namespace

ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target,
                               std::span<const std::uint32_t> interest, std::span<const DistantBeam> beams,
                               double lift_m, int threads) {
  ReliefContrast result;
  if (interest.empty() || beams.empty()) return result;
  std::vector<std::uint32_t> asked;  // interest points and their neighbours, each once
  for (const std::uint32_t i : interest) {
    LUXRIG_CHECK(i < surface.points_m.size(), "point {} of {}", i, surface.points_m.size());
    asked.push_back(i);
    asked.insert(asked.end(), surface.ring(i).begin(), surface.ring(i).end());
  }
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  std::vector<std::uint32_t> place(surface.points_m.size(), kNotAsked);
  for (std::uint32_t k = 0; k < asked.size(); ++k) place[asked[k]] = k;

  std::vector<std::uint8_t> lit(asked.size() * beams.size(), 0);
  std::vector<double> illuminance_lx(asked.size(), 0);
  const std::size_t tasks = (asked.size() + kPointsPerContrastTask - 1) / kPointsPerContrastTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    std::vector<Vec3f> directions;
    std::vector<std::uint8_t> blocked;
    for (std::size_t k = task * kPointsPerContrastTask; k < std::min(asked.size(), (task + 1) * kPointsPerContrastTask);
         ++k) {
      const Vec3& normal = surface.normals[asked[k]];
      if (normal.isZero(0)) continue;
      directions.clear();
      for (const DistantBeam& beam : beams) directions.push_back(beam.direction.cast<float>());
      blocked.assign(beams.size(), 0);
      target.blocked(surface.point_world_m(asked[k]), normal, lift_m, directions, blocked);
      for (std::size_t b = 0; b < beams.size(); ++b) {
        const double cosine = normal.dot(beams[b].direction);
        if (blocked[b] || cosine <= 0) continue;
        lit[k * beams.size() + b] = 1;
        illuminance_lx[k] += beams[b].illuminance_lx * cosine;
      }
    }
  });

  double points = 0, pairs = 0, all_pairs = 0, contrast_lx = 0, reached = 0;
  for (const std::uint32_t i : interest) {
    const std::uint32_t mine = place[i];
    const auto row = [&](std::uint32_t k) { return std::span(lit).subspan(k * beams.size(), beams.size()); };
    bool any = false;
    double largest_lx = 0;
    for (const std::uint32_t neighbour : surface.ring(i)) {
      const std::uint32_t theirs = place[neighbour];
      const bool differs = !std::ranges::equal(row(mine), row(theirs));
      any |= differs;
      pairs += differs ? 1 : 0;
      ++all_pairs;
      largest_lx = std::max(largest_lx, std::abs(illuminance_lx[mine] - illuminance_lx[theirs]));
    }
    points += any ? 1 : 0;
    contrast_lx += largest_lx;
    reached += std::ranges::any_of(row(mine), [](std::uint8_t one) { return one != 0; }) ? 1 : 0;
  }
  const auto count = static_cast<double>(interest.size());
  result.points_with_transition = points / count;
  result.pairs_with_transition = all_pairs > 0 ? pairs / all_pairs : 0;
  result.local_contrast_lx = contrast_lx / count;
  result.lit_points = reached / count;
  return result;
}

}  // namespace luxrig
