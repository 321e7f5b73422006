#pragma once
/// The two steps of make_surface_patches. Internal to core/goals.

#include "core/goals/surface_patches.h"

namespace luxrig {

/// The part of one triangle in one cell. Its normal is that of one of its sides, no matter which.
struct DicedPiece {
  Vec3f position_m;  ///< centroid
  Vec3f normal;
  float area_m2;
};

/// Patches of the pieces in one cell, appended. Sorts the pieces.
void append_patches_of_cell(std::span<DicedPiece> pieces, const Vec3f& cell_middle_m, double cell_m,
                            std::vector<SurfacePatch>& patches);

/// Cells and patches, without links and groups.
[[nodiscard]] Result<SurfacePatches> dice_surfaces(const Scene& scene, const PatchOptions& options);

/// Adds links and groups.
void link_patches(const RayScene& rays, int threads, SurfacePatches& surface);

/// A place before a surface from which its neighbourhood is seen: a quarter of a cell along the normal, or halfway to
/// what stands nearer than that.
[[nodiscard]] Vec3 lifted_world_m(const SurfacePlace& place, double cell_m, const RayScene& rays);

}  // namespace luxrig
