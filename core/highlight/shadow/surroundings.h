#pragma once
/// Objects between a target and its lights, without the target.

#include <cstdint>
#include <span>

#include "core/scene/ray_scene.h"

namespace luxrig {

/// Without the target, which would block itself. Both block light; a picture shows only the environment.
struct Surroundings {
  const RayScene* environment = nullptr;  ///< walls, pedestals, a glass case's frame; null = none
  const RayScene* occluders = nullptr;    ///< where people may stand; null = none
};

enum class Blocked : std::uint8_t { by_nothing, by_environment, by_occluders };

/// What blocks the way from a place to each of others, which may lie on a surface; the environment if both do.
void find_blocked(const Surroundings& surroundings, const Vec3& from_world_m, std::span<const Vec3> to_world_m,
                  std::span<Blocked> blocked);

}  // namespace luxrig
