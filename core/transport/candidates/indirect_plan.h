#pragma once
/// Choosing how finely to look, and building the importance fields.

#include "core/transport/candidates/indirect_columns.h"

namespace luxrig {

struct IndirectSettings {
  double cell_m = 0;
  std::uint32_t rays_per_cell = 16;
  std::uint32_t guided_rays_per_cell = 64;
  bool keep_links = false;  ///< so that receivers can move
};

/// Edge of cells of which `cells` cover the scene's area.
[[nodiscard]] double cell_size_m(const Scene& scene, std::size_t cells);

/// Relative error of reflected light that replicates cannot show, since they share it: light and importance that vary
/// together within a cell. 1 % for 10 000 cells, and as the size of a cell (measured in the furnished flat: -1.3 % with
/// 10 000, -5 % with 2 500; in an empty cube a fifth of that).
[[nodiscard]] double flatness_error(std::size_t cells);

/// Fields for the settings, one after another seeded; Cause::cancelled when stopped.
[[nodiscard]] Result<std::vector<std::unique_ptr<SurfaceImportance>>> importance_fields(
    const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
    std::span<const Vec3> also_from_world_m, const IndirectSettings& settings, const CandidateOptions& options);

/// The cheapest settings that give the wanted error on a few of the candidates, and what they need. Adds to statistics.
[[nodiscard]] Result<IndirectColumns> plan_indirect(const Scene& scene, const VisibilityScene& visibility,
                                                    std::span<const Receiver> receivers, const CandidateSet& candidates,
                                                    std::span<const CandidateLuminaire> luminaires,
                                                    std::span<const std::uint8_t> usable,
                                                    const CandidateOptions& options, CandidateStatistics& statistics);

}  // namespace luxrig
