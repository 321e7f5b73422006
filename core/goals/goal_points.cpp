#include "core/goals/goal_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace luxrig {
namespace {

/// Spacing grows by this share of the distance, so that dense and sparse points blend.
constexpr double kGrowth = 0.5;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t z = seed * 0xd1342543de82ef95 + (number + 1) * 0x9e3779b97f4a7c15;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  return z ^ z >> 31;
}

double apart_m(const SurfacePatches& surface, std::uint32_t p, std::uint32_t q) {
  return (surface.patches[p].position_m - surface.patches[q].position_m).cast<double>().norm();
}

/// Spacing at which the lux changes by `step` on the steepest way to a painted neighbour.
double spacing_for_detail(const SurfacePatches& surface, std::span<const float> lux, std::uint32_t patch,
                          const GoalSampling& sampling) {
  double steepest_per_m = 0;
  for (const PatchLink& link : surface.links_of(patch)) {
    if (std::isnan(lux[link.patch])) continue;
    const double here = lux[patch], there = lux[link.patch];
    const double length_m = surface.grid.cell_m() * link.length / kLengthsPerCell;
    if (here != there)
      steepest_per_m = std::max(steepest_per_m, std::abs(here - there) / std::max(here, there) / length_m);
  }
  if (steepest_per_m == 0) return sampling.max_spacing_m;
  return std::clamp(sampling.step / steepest_per_m, sampling.min_spacing_m, sampling.max_spacing_m);
}

/// Unpainted patches ask for no spacing.
double finite(double spacing_m) { return spacing_m < kInfinite ? spacing_m : 0; }

/// Chosen patches, in the order in which they were chosen.
std::vector<std::uint32_t> chosen_patches(const SurfacePatches& surface, const std::vector<double>& spacing_m,
                                          std::uint64_t seed) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < surface.size(); ++p)
    if (spacing_m[p] < kInfinite) order.push_back(p);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint64_t mixed_a = mixed(seed, a), mixed_b = mixed(seed, b);
    return mixed_a != mixed_b ? mixed_a < mixed_b : a < b;
  });
  std::vector<std::uint32_t> chosen, near;
  std::vector<std::uint8_t> covered(surface.size(), 0), met(surface.size(), 0);
  for (const std::uint32_t p : order) {
    if (covered[p]) continue;
    chosen.push_back(p);
    near = {p};
    met[p] = 1;
    for (std::size_t i = 0; i < near.size(); ++i)
      for (const PatchLink& link : surface.links_of(near[i])) {
        const std::uint32_t q = link.patch;
        if (met[q] || apart_m(surface, p, q) >= std::max(spacing_m[p], finite(spacing_m[q]))) continue;
        met[q] = covered[q] = 1;
        near.push_back(q);
      }
    for (const std::uint32_t q : near) met[q] = 0;
  }
  return chosen;
}

}  // namespace

std::vector<double> spacing_of(const SurfacePatches& surface, std::span<const float> lux,
                               const GoalSampling& sampling) {
  std::vector<double> spacing_m(surface.size(), kInfinite);
  using Reached = std::pair<double, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> nearest;
  for (std::uint32_t p = 0; p < surface.size(); ++p) {
    if (std::isnan(lux[p])) continue;
    spacing_m[p] = spacing_for_detail(surface, lux, p, sampling);
    nearest.emplace(spacing_m[p], p);
  }
  while (!nearest.empty()) {
    const auto [reached_m, p] = nearest.top();
    nearest.pop();
    if (reached_m > spacing_m[p]) continue;
    for (const PatchLink& link : surface.links_of(p)) {
      const double there_m = reached_m + kGrowth * apart_m(surface, p, link.patch);
      if (std::isnan(lux[link.patch]) || there_m >= spacing_m[link.patch]) continue;
      spacing_m[link.patch] = there_m;
      nearest.emplace(there_m, link.patch);
    }
  }
  return spacing_m;
}

std::vector<GoalPoint> goal_points(const SurfacePatches& surface, std::span<const float> lux, const SurfaceGoal& goal,
                                   const GoalSampling& sampling) {
  const std::vector<double> spacing_m = spacing_of(surface, lux, sampling);
  const std::vector<std::uint32_t> chosen = chosen_patches(surface, spacing_m, sampling.seed);
  SeedRegions nearest(surface);
  std::vector<std::uint32_t> unused;
  for (std::uint32_t i = 0; i < chosen.size(); ++i) {
    nearest.add(i, chosen[i], unused);
    unused.clear();
  }
  std::vector<GoalPoint> points(chosen.size());
  double all_m2 = 0;
  for (std::uint32_t p = 0; p < surface.size(); ++p) {
    if (std::isnan(lux[p])) continue;
    points[nearest.owner(p)].area_m2 += surface.patches[p].area_m2;
    all_m2 += surface.patches[p].area_m2;
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    GoalPoint& point = points[i];
    point.name = goal.name + " " + std::to_string(i + 1);
    point.place = {surface.position_world_m(chosen[i]), surface.patches[chosen[i]].normal.cast<double>().normalized()};
    point.goal_lx = lux[chosen[i]];
    point.max_lx = goal.max_lx;
    point.weight = goal.weight * point.area_m2 * static_cast<double>(points.size()) / all_m2;
  }
  return points;
}

}  // namespace luxrig
