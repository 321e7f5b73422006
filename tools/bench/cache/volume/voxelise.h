#pragma once
/// The voxels that a scene's triangles pass through.

#include "core/scene/scene.h"
#include "tools/bench/cache/volume/bit_volume.h"

namespace luxrig {

/// Box of the triangles, relative to the scene's origin; empty if there are none.
[[nodiscard]] Eigen::AlignedBox3d triangle_bounds_m(const Scene& scene);

/// Binary voxelisation (thesis §3.2.3, Alg. 1; after E. Eisemann and X. Décoret, 2006): each triangle is rasterised
/// along the dominant axis of its normal, and the results are merged by OR. Here each column that the triangle touches
/// gets all voxels between the triangle's smallest and greatest depth in it. So every point of every triangle lies in a
/// set voxel and no wall has a hole; there is at most one voxel too many along the edges. A triangle without area
/// counts as a segment.
///
/// requires finite vertices, and a grid that holds them (VoxelGrid::around(triangle_bounds_m(scene), …)).
[[nodiscard]] BitVolume voxelise(const Scene& scene, const VoxelGrid& grid);

}  // namespace luxrig
