#pragma once
/// Chooses the resolution, and builds the importance fields.

#include "core/transport/candidates/reflected/indirect_columns.h"
#include "core/transport/candidates/reflected/interpolation_nodes.h"

namespace luxrig {

struct IndirectSettings {
  double cell_m = 0;
  std::uint32_t rays_per_cell = 16;
  std::uint32_t guided_rays_per_cell = 128;
  bool keep_links = false;  ///< so that receivers can move
};

/// Edge of a cell if `cells` cells cover the scene's area.
[[nodiscard]] double cell_size_m(const Scene& scene, std::size_t cells);

/// Relative error of reflected light that replicates share and so cannot show: light and importance vary together
/// within a cell. Proportional to the distance of places: 0.9 % for 12 000 cells.
[[nodiscard]] double flatness_error(std::size_t cells);

/// Fields for these settings, with successive seeds; Cause::cancelled when stopped.
[[nodiscard]] Result<std::vector<std::unique_ptr<SurfaceImportance>>> importance_fields(
    const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
    std::span<const Vec3> also_from_world_m, const IndirectSettings& settings, const CandidateOptions& options);

/// Positions at which reflected light is evaluated; empty if there are few candidates.
[[nodiscard]] InterpolationNodes choose_nodes(const CandidateSet& candidates, std::span<const std::uint8_t> usable,
                                              std::size_t receivers, const CandidateOptions& options);

/// Fields, and the number of rays that gives the wanted error on a few of the candidates. Adds to statistics, and sets
/// its rays_per_candidate and rays_per_node.
[[nodiscard]] Result<IndirectColumns> plan_indirect(const Scene& scene, const VisibilityScene& visibility,
                                                    std::span<const Receiver> receivers, const CandidateSet& candidates,
                                                    std::span<const CandidateLuminaire> luminaires,
                                                    std::span<const std::uint8_t> usable,
                                                    const InterpolationNodes& nodes, const CandidateOptions& options,
                                                    CandidateStatistics& statistics);

}  // namespace luxrig
