#pragma once
/// One highlight task: lights that do not hang yet, found on what may carry them
/// (core/highlight/lights/judged_lights.h), then aimed and dimmed as heads that hang are (aim_heads.h).

#include "core/solve/placement/mounting.h"
#include "core/solve/placement/place_in_scene.h"
#include "core/tasks/relief_task.h"

namespace luxrig {

struct PlacedReliefLights {
  std::vector<LightInScene> lights;
  AimScore score;
  std::vector<double> contrast_lx;  ///< of one light, two, … at full level; empty when their number was given
  std::size_t tried = 0;
};

/// Refuses when no light that may hang brings out anything of the object, saying why.
[[nodiscard]] Result<PlacedReliefLights> find_relief_lights(const ReliefSurroundings& around,
                                                            const StudiedObject& object, const Task& task,
                                                            const Mounting& mounting, const ComputeOptions& options);

}  // namespace luxrig
