#pragma once
/// The room within its scene: a ground of 20 km beneath it says nothing of where the room ends.

#include <optional>
#include <span>

#include "core/scene/scene.h"

namespace luxrig {

/// Of what is built around the things of a rig.
struct RoomBounds {
  Eigen::AlignedBox3d built_world_m;
  /// The same, and where the scene reaches farther, also the nearest four fifths of the things: what stands on open
  /// ground with little built there is in its place too.
  Eigen::AlignedBox3d with_things_world_m;
};

/// What is built around `things_world_m`: lamps, meters, goals, of which nearly all are taken to be in their place.
/// Where the scene reaches more than 30 times as far around their middle as most of them do (and farther than 150 m),
/// what lies farther off does not count, nor do flat faces that go on from there: a ground plane, cut up or not. Ground
/// with hills counts as far as that. The whole scene where it does not reach so far, where there are no things, or
/// where nothing is left. With `object`, of that object alone, as in Scene::object_of_triangle.
[[nodiscard]] RoomBounds room_bounds_of(const Scene& scene, std::span<const Vec3> things_world_m,
                                        std::optional<std::uint32_t> object = std::nullopt);

}  // namespace luxrig
