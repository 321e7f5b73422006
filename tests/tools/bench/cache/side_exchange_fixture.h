#pragma once
/// Shared by the tests of side_exchange.

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tools/bench/cache/side_exchange.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig::side_exchange_fixture {

struct Exchange {
  Scene scene;
  RayScene rays;
  SurfaceSides sides;
  std::vector<bool> seen;

  explicit Exchange(Scene of)
      : scene(std::move(of)),
        rays(scene),
        sides(scene, rays, VoxelGrid::around(triangle_bounds_m(scene), 16), 4, 1),
        seen(sides.groups(), false) {
    for (const SurfacePiece& piece : sides.pieces())
      if (piece.normal_world.cast<double>().dot(-piece.position_world_m) > 0)
        seen[sides.group_of_side(piece.side)] = true;
  }
  SideExchange make(bool only_needed, int reflections, int threads = 2) const {
    return {scene, rays, sides, seen, only_needed, reflections, 128, 1, 1, threads, {}};
  }
};

}  // namespace luxrig::side_exchange_fixture
