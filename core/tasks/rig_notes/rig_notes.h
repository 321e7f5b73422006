#pragma once
/// Does the rig fit its scene? What is legal to read but plainly not meant, each with its figure and what would mend
/// it: for a person before anything is computed, hung or sent.

#include "core/rig/rig.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"

namespace luxrig {

/// A scene read in a wrong unit or with a wrong axis up (then only that: the rest follows from it), or else, each at
/// its place in the rig file:
/// - fixtures outside of the scene that no point sees, or far away from it
/// - points and luxmeters outside of the scene, inside of an object, behind or right before a surface, or that no lamp
///   reaches, direct or reflected
/// - lamps within 2 cm of a point or luxmeter
/// Nothing is said of a scene without a triangle. Costs one shadow ray per lamp and point, and paths for the points
/// that get no direct light. Deterministic.
[[nodiscard]] std::vector<Problem> notes_on(const Rig& rig, const Scene& scene, const RayScene& rays, int threads = 0,
                                            std::stop_token stop = {});

/// The bounds of the room that the rig's things are in, without a ground that goes on far beyond it
/// (core/scene/room_bounds.h): what notes_on() means by the scene, and what a plan view shows.
[[nodiscard]] Eigen::AlignedBox3d room_of(const Rig& rig, const Scene& scene);

/// Lamps that lie in a point or luxmeter: it would get infinitely much light, and nothing can be computed.
[[nodiscard]] std::vector<Problem> lamps_in_points(const Rig& rig);

}  // namespace luxrig
