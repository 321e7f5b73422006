#pragma once
/// Which part of a scene the cells of a cache are for.

#include <cstdint>
#include <span>

#include "core/scene/scene.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// The box, in the scene's frame, of what receivers see from near: all of the scene, unless that is far larger (a room
/// whose door opens to a kilometre of ground); then what 99 of 100 rays from receivers meet along each axis, the
/// receivers themselves, and half as much again on each side.
[[nodiscard]] Eigen::AlignedBox3d seen_part_m(const Scene& scene, const RayScene& rays,
                                              std::span<const Receiver> receivers, std::uint64_t seed);

}  // namespace luxrig
