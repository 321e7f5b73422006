#include "core/transport/candidates/indirect_plan.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Candidates that cells are also grown from.
constexpr std::size_t kGrownFrom = 256;

}  // namespace

double cell_size_m(const Scene& scene, std::size_t cells) {
  double area_m2 = 0;
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertex_world_m(t[0]);
    area_m2 += 0.5 * (scene.vertex_world_m(t[1]) - a).cross(scene.vertex_world_m(t[2]) - a).norm();
  }
  return std::max(std::sqrt(area_m2 / static_cast<double>(cells)), 1e-9);
}

Result<std::vector<std::unique_ptr<SurfaceImportance>>> importance_fields(
    const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
    std::span<const Vec3> also_from_world_m, const IndirectSettings& settings, const CandidateOptions& options) {
  std::vector<std::unique_ptr<SurfaceImportance>> fields(IndirectColumns::kReplicates);
  parallel_for(fields.size(), options.threads, [&](std::size_t k) {
    ImportanceSettings one;
    one.cell_m = settings.cell_m;
    one.rays_per_cell = settings.rays_per_cell;
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
                                      std::span<const CandidateLuminaire> luminaires, const ReceiversAir* air,
                                      const CandidateOptions& options, CandidateStatistics& statistics) {
  std::vector<Vec3> some_m;
  const std::size_t positions = candidates.positions_world_m.size();
  const std::size_t wanted = std::min(positions, kGrownFrom);
  for (std::size_t i = 0; i < wanted; ++i) {
    const Vec3& at = candidates.positions_world_m[i * positions / wanted];
    if (!air || air->reaches(at)) some_m.push_back(at);
  }
  IndirectSettings settings;
  settings.cell_m = cell_size_m(scene, 10'000);
  auto fields = importance_fields(scene, visibility, receivers, some_m, settings, options);
  if (!fields) return tl::unexpected(std::move(fields.error()));
  for (const auto& field : *fields) {
    statistics.rays += field->rays();
    statistics.surface_cells += field->surfaces().cells().size();
  }
  statistics.rays_per_candidate = settings.rays_per_replicate * IndirectColumns::kReplicates;
  return IndirectColumns(*visibility.rays, std::move(*fields), luminaires, settings.rays_per_replicate, options.seed);
}

}  // namespace luxrig
