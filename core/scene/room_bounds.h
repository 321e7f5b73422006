#pragma once
/// Bounds of the room in its scene, ignoring for example a ground plane of 20 km beneath it.

#include <optional>
#include <span>

#include "core/scene/scene.h"

namespace luxrig {

/// Bounds of the built surroundings of a rig's things.
struct RoomBounds {
  Eigen::AlignedBox3d built_world_m;
  /// The same, and if the scene extends farther, also the nearest four fifths of the things. Things on open ground with
  /// few buildings belong there, too.
  Eigen::AlignedBox3d with_things_world_m;
};

/// Bounds of the building around `things_world_m` (lamps, meters, goals), nearly all of which are taken to be well
/// placed. A scene is too large if it extends more than 30 times as far around the things' middle as most of them do,
/// and farther than 150 m. Parts beyond that distance do not count, nor do flat faces that continue beyond it (a ground
/// plane, cut or not). Hilly ground counts up to that distance. The result is the whole scene if it is not too large,
/// if there are no things, or if nothing remains. With `object`, bounds of that object alone, as in
/// Scene::object_of_triangle.
[[nodiscard]] RoomBounds room_bounds_of(const Scene& scene, std::span<const Vec3> things_world_m,
                                        std::optional<std::uint32_t> object = std::nullopt);

}  // namespace luxrig
