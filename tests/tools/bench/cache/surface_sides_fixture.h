#pragma once
/// Shared by the tests of surface_sides.

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tools/bench/cache/surface_sides.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig::surface_sides_fixture {

inline SurfaceSides sides_of(const Scene& scene, const RayScene& rays, int cells, int group_cells = 4,
                             int threads = 2) {
  return {scene, rays, VoxelGrid::around(triangle_bounds_m(scene), cells), group_cells, threads};
}

}  // namespace luxrig::surface_sides_fixture
