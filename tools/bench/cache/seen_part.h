#pragma once
/// The part of a scene that the cells of a cache cover.

#include <cstdint>
#include <span>

#include "core/scene/scene.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// The box, in the scene's frame, that receivers see from nearby. It is the whole scene, unless that is far larger (a
/// room with a door to a kilometre of ground). Then it holds 99 of 100 hits of rays from receivers along each axis and
/// the receivers themselves, with half of its longest side as a margin on each side.
[[nodiscard]] Eigen::AlignedBox3d seen_part_m(const Scene& scene, const RayScene& rays,
                                              std::span<const Receiver> receivers, std::uint64_t seed);

}  // namespace luxrig
