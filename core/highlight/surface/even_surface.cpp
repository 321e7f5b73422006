#include "core/highlight/surface/even_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/highlight/surface/surface_samples.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kMaxPoints = 1e6, kMaxSlivers = 3e7;
constexpr double kSpacing = 0.2;                  ///< of the scale: least distance of points that face alike
constexpr double kWidestSpacing = 0.35;           ///< used if that gives too many points; rings need it
constexpr double kRing = 0.7;                     ///< of the scale: distance of the points a point is compared with
constexpr double kRingFrom = 0.6, kRingTo = 1.5;  ///< of that distance
constexpr std::size_t kSectors = 6;
constexpr double kStandOff = 0.003;  ///< of the size
constexpr std::size_t kPointsPerRingTask = 256;

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A subset of the samples with at least `apart_m` between any two that face alike, each with the area of all samples
/// nearest to it. Chosen in an order unrelated to position.
std::vector<SurfaceSample> spread_out(std::vector<SurfaceSample> all, double apart_m) {
  const SampleGrid grid(std::move(all), apart_m);
  const std::span<const SurfaceSample> samples = grid.samples();
  std::vector<std::uint32_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [](std::uint32_t a, std::uint32_t b) { return mixed(a) < mixed(b); });
  std::vector<std::uint32_t> owner(samples.size(), TargetSurface::kNone), kept;
  std::vector<double> distance2_m2(samples.size(), std::numeric_limits<double>::infinity());
  std::vector<std::span<const SurfaceSample>> stretches;
  for (const std::uint32_t k : order) {
    if (owner[k] != TargetSurface::kNone || samples[k].normal.isZero(0) || !(samples[k].area_m2 > 0)) continue;
    grid.near(samples[k].position_m, apart_m, stretches);
    for (const auto& stretch : stretches) {
      auto s = static_cast<std::size_t>(stretch.data() - samples.data());
      for (const SurfaceSample& sample : stretch) {
        const double away2_m2 = (sample.position_m - samples[k].position_m).squaredNorm();
        if (away2_m2 < apart_m * apart_m && away2_m2 < distance2_m2[s] && sample.normal.dot(samples[k].normal) > 0) {
          owner[s] = static_cast<std::uint32_t>(kept.size());
          distance2_m2[s] = away2_m2;
        }
        ++s;
      }
    }
    kept.push_back(k);
  }
  std::vector<SurfaceSample> result;
  for (const std::uint32_t k : kept) result.push_back({samples[k].position_m, samples[k].normal, 0});
  for (std::size_t s = 0; s < samples.size(); ++s)
    if (owner[s] != TargetSurface::kNone) result[owner[s]].area_m2 += samples[s].area_m2;
  return result;
}

/// Per point: in each sector around its normal, the point whose distance is nearest to `distance_m`.
void add_far_rings(TargetSurface& surface, const SampleGrid& grid, double distance_m, int threads) {
  const std::span<const SurfaceSample> samples = grid.samples();
  std::vector<std::array<std::uint32_t, kSectors>> rings(samples.size());
  const std::size_t tasks = (samples.size() + kPointsPerRingTask - 1) / kPointsPerRingTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    std::vector<std::span<const SurfaceSample>> stretches;
    for (std::size_t i = task * kPointsPerRingTask; i < std::min(samples.size(), (task + 1) * kPointsPerRingTask);
         ++i) {
      const Vec3& normal = surface.normals[i];
      const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
      rings[i].fill(TargetSurface::kNone);
      std::array<double, kSectors> off;
      off.fill(std::numeric_limits<double>::infinity());
      grid.near(samples[i].position_m, kRingTo * distance_m, stretches);
      for (const auto& stretch : stretches) {
        auto s = static_cast<std::uint32_t>(stretch.data() - samples.data());
        for (const SurfaceSample& sample : stretch) {
          const std::uint32_t here = s++;
          const Vec3 way_m = sample.position_m - samples[i].position_m;
          const double share = way_m.norm() / distance_m;
          if (!(share > kRingFrom && share < kRingTo) || !(surface.normals[here].dot(normal) > 0)) continue;
          const double turn = (std::atan2(way_m.dot(y), way_m.dot(x)) + kPi) / (2 * kPi);
          const std::size_t sector = std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors));
          if (std::abs(share - 1) >= off[sector]) continue;
          off[sector] = std::abs(share - 1);
          rings[i][sector] = here;
        }
      }
      std::sort(rings[i].begin(), rings[i].end());
    }
  });
  for (const auto& ring : rings) {
    for (const std::uint32_t point : ring)
      if (point != TargetSurface::kNone) surface.rings_.push_back(point);
    surface.ring_begin_.push_back(static_cast<std::uint32_t>(surface.rings_.size()));
  }
}

}  // namespace

Result<EvenSurface> even_surface(const TargetSurface& mesh, const EvenSurfaceOptions& options) {
  if (!(options.scale_m > 0) || !std::isfinite(options.scale_m))
    return refusal(fmt::format("a surface cannot be told by points at a scale of {} m", options.scale_m));
  // At most about one point per square of their distance.
  const double min_apart_m = std::sqrt(mesh.area_m2() / kMaxPoints);
  if (min_apart_m > kWidestSpacing * options.scale_m)
    return refusal(
        fmt::format("a scale of {:.3g} m is too fine for a surface of {:.3g} m²: it can be told from {:.3g} m up",
                    options.scale_m, mesh.area_m2(), min_apart_m / kWidestSpacing));
  const double apart_m = std::max(kSpacing * options.scale_m, min_apart_m), distance_m = kRing * options.scale_m;
  const double piece_m = 0.75 * apart_m;
  // Long thin facets need many pieces for little area.
  if (const double pieces = pieces_of_surface(mesh, piece_m, piece_m); pieces > kMaxSlivers)
    return refusal(
        fmt::format("its {} facets are so long that they would have to be cut into {:.1g} pieces at a scale of "
                    "{:.3g} m: take a larger scale, or mesh it anew with even triangles",
                    mesh.triangles.size(), pieces, options.scale_m));
  std::vector<SurfaceSample> fine =
      merged_in_cells(surface_samples(mesh, piece_m, piece_m, std::numeric_limits<double>::infinity()), apart_m / 2);
  const SampleGrid grid(spread_out(std::move(fine), apart_m), distance_m);
  EvenSurface even;
  even.surface.origin_world_m = mesh.origin_world_m;
  for (const SurfaceSample& sample : grid.samples()) {
    even.surface.points_m.push_back(sample.position_m);
    even.surface.normals.push_back(sample.normal);
    even.surface.areas_m2.push_back(sample.area_m2);
  }
  auto curvature =
      curvature_at(mesh, even.surface.points_m, even.surface.normals, {options.of_part(), options.scale_m});
  if (!curvature) return tl::unexpected(curvature.error());
  even.curvature = std::move(*curvature);
  for (std::size_t i = 0; i < even.curvature.size(); ++i)
    if (even.curvature[i].known()) even.surface.normals[i] = even.curvature[i].normal;
  add_far_rings(even.surface, grid, distance_m, options.threads);
  const double off_m = kStandOff * mesh.size_m();
  for (std::size_t i = 0; i < even.surface.points_m.size(); ++i)
    even.surface.points_m[i] += off_m * even.surface.normals[i];
  return even;
}

}  // namespace luxrig
