#pragma once
/// Which voxels a scene's triangles pass through.

#include "core/scene/scene.h"
#include "tools/bench/cache/volume/bit_volume.h"

namespace luxrig {

/// Box of the triangles, relative to the scene's origin; empty when there are none.
[[nodiscard]] Eigen::AlignedBox3d triangle_bounds_m(const Scene& scene);

/// Binary voxelisation (thesis §3.2.3, Alg. 1; after E. Eisemann and X. Décoret, 2006): each triangle is rasterised
/// along the dominant axis of its normal, and the results are merged by OR. Here each column that the triangle touches
/// gets all voxels between the triangle's least and greatest depth in it, so that every point of every triangle lies
/// in a set voxel and no wall has a hole; at most one voxel more than needed along the edges. Triangles without area
/// count as the segment they are.
///
/// requires finite vertices, and a grid that holds them (VoxelGrid::around(triangle_bounds_m(scene), …)).
[[nodiscard]] BitVolume voxelise(const Scene& scene, const VoxelGrid& grid);

}  // namespace luxrig
