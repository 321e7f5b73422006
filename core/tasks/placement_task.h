#pragma once
/// One placement task, watched: time that is up and an interrupt end it with the best so far, and a person sees how far
/// it is.

#include "core/rig/rig.h"
#include "core/solve/placement/mounting.h"
#include "core/solve/placement/place_in_scene.h"
#include "core/tasks/session.h"

namespace luxrig {

/// Light that does not come from the lights that are sought.
struct LightThere {
  Eigen::VectorXd lux;
  Eigen::MatrixXd rgb;  ///< points × 3, linear Rec. 709; empty when no goal has a colour
};

/// there       of every point of the rig: light that is there anyway
/// max_watts   of the lights that are to be placed, together
/// lights      none when it meets every goal
/// options.watch.stop and the task's `seconds` end the search.
[[nodiscard]] Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays,
                                                  const Mounting& mounting, const Task& task, const LightThere& there,
                                                  double max_watts, const ComputeOptions& options);

}  // namespace luxrig
