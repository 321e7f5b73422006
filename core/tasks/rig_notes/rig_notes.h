#pragma once
/// Checks that the rig fits its scene. Finds entries that are legal but plainly not meant, each with its figure and a
/// remedy: for a person, before anything is computed, hung or sent.

#include "core/rig/rig.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Notes a scene read in a wrong unit or with a wrong axis up (then only that: the rest follows from it). Else, each
/// at its place in the rig file:
/// - fixtures outside of the scene that no point sees, or far away from it
/// - points and luxmeters outside of the scene, inside of an object, behind or right before a surface, or that no lamp
///   reaches, direct or reflected
/// - lamps within 2 cm of a point or luxmeter
/// A scene without a triangle gets no notes. Costs one shadow ray per lamp and point, and paths for the points without
/// direct light. Deterministic.
[[nodiscard]] std::vector<Problem> notes_on(const Rig& rig, const Scene& scene, const RayScene& rays, int threads = 0,
                                            std::stop_token stop = {});

/// Bounds of the room with the rig's things in it, without a ground that extends far beyond (core/scene/room_bounds.h).
/// notes_on() takes them as the scene; a plan view shows them.
[[nodiscard]] Eigen::AlignedBox3d room_of(const Rig& rig, const Scene& scene);

/// Lamps that lie in a point or luxmeter. Its light would be infinite, and nothing could be computed.
[[nodiscard]] std::vector<Problem> lamps_in_points(const Rig& rig);

}  // namespace luxrig
