#include "core/transport/candidates/reflected/indirect_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/candidates/error_histogram.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Candidates used as extra starts for cells, and candidates used to find the number of rays.
constexpr std::size_t kGrownFrom = 256;
constexpr std::size_t kTried = 48;
/// Rays per replicate in these trials.
constexpr std::uint32_t kFewTried = 32, kManyTried = 256;
/// Rays may always add this share of the square of the fields' own error, even if the fields use up the wanted error: a
/// smaller share would cost many rays and gain little.
constexpr double kMinRayShare = 0.25;
constexpr double kAloneShare = 0.5;
constexpr std::size_t kMinCells = 200;
/// One node per this many positions. With many positions, fewer: even sparser nodes are then close together.
constexpr std::size_t kPositionsPerNode = 3;
constexpr std::size_t kManyNodes = 16'384, kManyPositionsPerNode = 16;
constexpr std::size_t kMinPositions = 256;
/// Fraction of the memory bound for the nodes' values.
constexpr std::size_t kNodesShare = 4;

/// Median of standard error / lux over the entries of some candidates.
double median_error(const IndirectColumns& indirect, const VisibilityScene& visibility,
                    std::span<const Receiver> receivers, std::span<const Vec3> positions_m,
                    std::span<const CandidateLuminaire> luminaires, std::uint32_t rays_per_replicate,
                    const CandidateOptions& options, std::uint64_t& rays) {
  std::vector<ErrorHistogram> errors(positions_m.size());
  std::vector<std::uint64_t> cast(positions_m.size(), 0);
  const double min_lux = options.skips.reach ? options.min_lux : 0;
  parallel_for(positions_m.size(), options.threads, [&](std::size_t i) {
    if (options.watch.stop.stop_requested()) return;
    const CandidateLuminaire& luminaire = luminaires[i % luminaires.size()];
    const Vec3 at_m = positions_m[i] + luminaire.offset_world_m;
    std::vector<float> replicates(IndirectColumns::kReplicates * indirect.stride()), lux(receivers.size()),
        error_lux(receivers.size());
    cast[i] += indirect.evaluate(luminaire, at_m, indirect.guide(luminaire, std::span(&at_m, 1), cast[i]),
                                 {rays_per_replicate, i, options.skips.unlit}, replicates);
    indirect.summarise(replicates, {}, lux, error_lux);
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      double all_lux = unobstructed_lux(luminaire, at_m, receivers[r]);
      if (all_lux > 0) {
        ++cast[i];
        if (visibility.rays->occluded(receivers[r].position_world_m, receivers[r].normal_world, at_m)) all_lux = 0;
      }
      all_lux += static_cast<double>(lux[r]);
      if (all_lux > 0 && all_lux >= min_lux) errors[i].add(static_cast<double>(error_lux[r]) / all_lux);
    }
  });
  ErrorHistogram all;
  for (const ErrorHistogram& one : errors) all.add(one);
  for (const std::uint64_t n : cast) rays += n;
  return all.median();
}

/// Median share of the nodes' squared noise that remains in interpolated results; 1 for positions without any.
double noise_share(const InterpolationNodes& nodes, const VisibilityScene& visibility,
                   std::span<const Vec3> positions_m, std::span<const CandidateLuminaire> luminaires,
                   std::uint64_t& rays) {
  std::vector<double> noises;
  std::vector<WeightedRow> shares;
  for (const Vec3& at_m : positions_m) {
    nodes.shares(*visibility.rays, at_m, luminaires.front().offset_world_m, shares, rays);
    double noise = shares.empty() ? 1 : 0;
    for (const WeightedRow& share : shares)
      noise += static_cast<double>(share.weight) * static_cast<double>(share.weight);
    noises.push_back(std::min(noise, 1.0));
  }
  if (noises.empty()) return 1;
  const auto middle = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2);
  std::nth_element(noises.begin(), middle, noises.end());
  return *middle;
}

std::vector<Vec3> spread(std::span<const Vec3> positions_m, std::size_t most) {
  std::vector<Vec3> some_m;
  const std::size_t count = std::min(positions_m.size(), most);
  for (std::size_t i = 0; i < count; ++i) some_m.push_back(positions_m[i * positions_m.size() / count]);
  return some_m;
}

}  // namespace

double cell_size_m(const Scene& scene, std::size_t cells) {
  double area_m2 = 0;
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertex_world_m(t[0]);
    area_m2 += 0.5 * (scene.vertex_world_m(t[1]) - a).cross(scene.vertex_world_m(t[2]) - a).norm();
  }
  return std::max(std::sqrt(area_m2 / static_cast<double>(cells)), 1e-9);
}

InterpolationNodes choose_nodes(const CandidateSet& candidates, std::span<const std::uint8_t> usable,
                                std::size_t receivers, const CandidateOptions& options) {
  const auto count = static_cast<std::size_t>(std::count(usable.begin(), usable.end(), std::uint8_t{1}));
  if (!options.skips.foretold || count < kMinPositions) return {};
  const std::size_t floats = (IndirectColumns::kReplicates + 1) * (receivers + kRowUnit) * candidates.luminaires.size();
  const std::size_t fit = options.memory_bound_bytes / kNodesShare / (floats * sizeof(float));
  const double step_m = InterpolationNodes::step_for(
      candidates.positions_world_m, usable,
      std::min({fit, count / kPositionsPerNode, std::max(kManyNodes, count / kManyPositionsPerNode)}));
  return step_m > 0 ? InterpolationNodes(candidates.positions_world_m, usable, step_m) : InterpolationNodes();
}

double flatness_error(std::size_t cells) {
  return 0.02 * std::sqrt(10'000 / static_cast<double>(cells * SurfaceCells::kPlaces));
}

Result<std::vector<std::unique_ptr<SurfaceImportance>>> importance_fields(
    const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
    std::span<const Vec3> also_from_world_m, const IndirectSettings& settings, const CandidateOptions& options) {
  std::vector<std::unique_ptr<SurfaceImportance>> fields(IndirectColumns::kReplicates);
  parallel_for(fields.size(), options.threads, [&](std::size_t k) {
    ImportanceSettings one;
    one.cell_m = settings.cell_m;
    one.rays_per_cell = settings.rays_per_cell;
    one.guided_rays_per_cell = settings.guided_rays_per_cell;
    one.keep_links = settings.keep_links;
    one.seed = mixed(options.seed, k);
    fields[k] = std::make_unique<SurfaceImportance>(scene, visibility, receivers, also_from_world_m, one, options.skips,
                                                    options.watch.stop);
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "stopped while solving the surfaces' importance", {}});
  return fields;
}

Result<IndirectColumns> plan_indirect(const Scene& scene, const VisibilityScene& visibility,
                                      std::span<const Receiver> receivers, const CandidateSet& candidates,
                                      std::span<const CandidateLuminaire> luminaires,
                                      std::span<const std::uint8_t> usable, const InterpolationNodes& nodes,
                                      const CandidateOptions& options, CandidateStatistics& statistics) {
  std::vector<Vec3> usable_m;
  for (std::size_t p = 0; p < usable.size(); ++p)
    if (usable[p]) usable_m.push_back(candidates.positions_world_m[p]);
  const std::vector<Vec3> grown_from_m = spread(usable_m, kGrownFrom);
  const std::size_t bytes_per_cell =
      (SurfaceCells::kPlaces + 1) * IndirectColumns::kReplicates * (receivers.size() + kRowUnit) * sizeof(float) +
      sizeof(SurfaceCells::Cell);
  const std::size_t cells_in_bound = options.memory_bound_bytes / 2 / bytes_per_cell;
  if (cells_in_bound < kMinCells)
    return tl::unexpected(
        Fault{Cause::invalid,
              "",
              fmt::format("the surfaces' importance for {} receivers needs {} bytes; the bound is {}", receivers.size(),
                          2 * kMinCells * bytes_per_cell, options.memory_bound_bytes),
              {}});
  IndirectSettings settings;
  const std::size_t cells = std::clamp(options.surface_cells, kMinCells, std::max(kMinCells, cells_in_bound));
  settings.cell_m = cell_size_m(scene, cells);
  auto fields = importance_fields(scene, visibility, receivers, grown_from_m, settings, options);
  if (!fields) return tl::unexpected(std::move(fields.error()));
  for (const auto& field : *fields) {
    statistics.rays += field->rays();
    statistics.surface_cells += field->surfaces().cells().size();
  }
  IndirectColumns indirect(*visibility.rays, std::move(*fields), flatness_error(cells), options.seed);

  const std::vector<Vec3> tried_m = spread(grown_from_m, kTried);
  const auto error_with = [&](std::uint32_t rays) {
    return median_error(indirect, visibility, receivers, tried_m, luminaires, rays, options, statistics.rays);
  };
  const double few = error_with(kFewTried), many = error_with(kManyTried);
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "stopped while counting out the rays of candidates", {}});
  // Squares add: the part from rays falls with their number, the part from the fields stays.
  const double of_one_ray = std::max(0.0, (few * few - many * many) / (1.0 / kFewTried - 1.0 / kManyTried));
  const double of_fields = std::max(0.0, many * many - of_one_ray / kManyTried);
  const double wanted = options.wanted_relative_error;
  const double left = std::max({wanted * wanted - of_fields, kMinRayShare * of_fields, 1e-12});
  const double most = std::max(2.0, options.max_rays_per_candidate / static_cast<double>(IndirectColumns::kReplicates));
  const auto rays_for = [&](double share) {
    const double rays = std::clamp(share * of_one_ray / left, std::min<double>(kFewTried, most), most);
    return static_cast<std::uint32_t>(IndirectColumns::kReplicates) * 2 * static_cast<std::uint32_t>(rays / 2);
  };
  // Candidates with their own rays are few: their error may be slightly larger than that of the others.
  statistics.rays_per_candidate = rays_for(kAloneShare);
  statistics.rays_per_node = rays_for(noise_share(nodes, visibility, tried_m, luminaires, statistics.rays));
  return indirect;
}

}  // namespace luxrig
