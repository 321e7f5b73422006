#pragma once
/// Shared by the tests of sky_openings.

#include "core/photometry/sky/sky.h"
#include "core/transport/sky/sky_opening_finder.h"
#include "core/transport/sky/sky_openings.h"
#include "tests/core/transport/sky/room_with_windows.h"

namespace luxrig::sky_openings_fixture {

inline Emitter lit_by(const Sky& sky) {
  Emitter emitter;
  emitter.sky = sky;
  return emitter;
}

inline SkyOpenings found(const RoomWithWindows& room, std::uint64_t seed = 1, std::uint64_t* rays = nullptr,
                         int threads = 1) {
  const RayScene scene(room.scene());
  const std::vector<Emitter> sky = {lit_by(make_overcast_sky(10'000))};
  std::uint64_t cast = 0;
  const SkyOpenings openings = find_sky_openings(scene, room.desks(), sky, seed, threads, {}, cast);
  if (rays) *rays = cast;
  return openings;
}

/// A rectangle of 2 m × 1 m that faces -y, with its lower edge at z = 1.
inline SkyOpening window() {
  SkyOpening opening;
  opening.centre_world_m = {0.3, 0, 1.5};
  opening.world_from_opening << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  opening.half_x_m = 1;
  opening.half_y_m = 0.5;
  opening.seen_from_world_m = {Vec3(-3, -3, -3), Vec3(3, 3, 3)};
  return opening;
}

}  // namespace luxrig::sky_openings_fixture
