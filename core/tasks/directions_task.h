#pragma once
/// One directions task: where a lamp that a person carries should be held, so that an object's relief reads
/// (core/highlight/distant/relief_lights.h).

#include "core/tasks/relief_task.h"

namespace luxrig {

struct HeldLights {
  std::vector<PlannedDirection> directions;
  double local_contrast_lx = 0;          ///< of beams of 1 lx each, at right angles to them
  double exposed_contrast = 0;           ///< contrast_samples.h, 0…1
  double coverage = 0;                   ///< share of the object's features with a shadow's edge
  std::vector<double> exposed_by_count;  ///< of one light, two, …; empty when their number was given
};

/// Lamps are so far away that their light is parallel. Directions in which another thing of the scene stands nearer
/// than the task's distance are left out. Refuses when none is left that brings out anything.
[[nodiscard]] Result<HeldLights> find_directions(const Session& session, const Task& task,
                                                 const ComputeOptions& options);

}  // namespace luxrig
