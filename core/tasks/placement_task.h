#pragma once
/// One placement task, watched: a timeout or an interrupt ends it with the best so far, and a person sees its progress.

#include "core/rig/rig.h"
#include "core/solve/placement/scene/mounting.h"
#include "core/solve/placement/scene/place_in_scene.h"
#include "core/tasks/session.h"

namespace luxrig {

/// Light from sources other than the lights to be placed.
struct LightThere {
  Eigen::VectorXd lux;
  Eigen::MatrixXd rgb;  ///< points × 3, linear Rec. 709; empty when no goal has a colour
};

/// there       light at every point of the rig without the new lights
/// max_watts   of all new lights together
/// lights      none if `there` meets every goal
/// options.watch.stop and the task's `seconds` end the search.
[[nodiscard]] Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays,
                                                  const Mounting& mounting, const Task& task, const LightThere& there,
                                                  double max_watts, const ComputeOptions& options);

}  // namespace luxrig
