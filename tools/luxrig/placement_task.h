#pragma once
/// One placement task, watched: time that is up and an interrupt end it with the best so far, and a person sees how far
/// it is.

#include "core/rig/rig.h"
#include "core/solve/placement/mounting.h"
#include "core/solve/placement/place_in_scene.h"
#include "tools/luxrig/session.h"

namespace luxrig {

/// fixed_lx   of every point of the rig: light that is there anyway
/// lights     none when fixed_lx meets every goal
/// options.watch.stop and the task's `seconds` end the search.
[[nodiscard]] Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays,
                                                  const Mounting& mounting, const Task& task,
                                                  const Eigen::VectorXd& fixed_lx, const ComputeOptions& options);

}  // namespace luxrig
